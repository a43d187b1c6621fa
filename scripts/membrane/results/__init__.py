# SPDX-License-Identifier: GPL-2.0-or-later
"""What runs leave: shapes, history, folders and their locks; reading it again. Knows no YADE."""
