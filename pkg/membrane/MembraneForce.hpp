// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "Membrane.hpp"
#include "kernels/ElementForce.hpp"
#include <core/GlobalEngine.hpp>

namespace yade {

class MembraneForce : public GlobalEngine {
public:
    void action() override;
    /// The force on the membrane's elements. It may keep this engine, and read its attributes in every step.
    virtual std::shared_ptr<::membrane::ElementForce> make() const;

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(MembraneForce, GlobalEngine,
        "A further force on the elements of a :yref:`Membrane`, as classes derived from this define it. The membrane's :yref:`MembraneForceEngine` computes it with its own "
        "while it stands in O.engines and is not dead, on both paths; its work is booked by :yref:`MembraneLedger`.",
        ((shared_ptr<Membrane>, membrane, , , "The membrane on which the force acts."))
        ,
        ,
    );
    // clang-format on
};
REGISTER_SERIALIZABLE(MembraneForce);

} // namespace yade
