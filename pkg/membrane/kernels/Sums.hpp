// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

namespace membrane {

/// What the energy ledger needs of a step: nothing, what it adds up in every step, or also the energies, which it needs
/// only when somebody looks.
enum class Sums { none, works, energies };

} // namespace membrane
