// SPDX-License-Identifier: GPL-2.0-or-later
#include "MembraneNode.hpp"

namespace yade {

YADE_PLUGIN((MembraneNode));

} // namespace yade
