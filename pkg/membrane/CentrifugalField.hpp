// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "Membrane.hpp"
#include <pkg/common/FieldApplier.hpp>

namespace yade {

class CentrifugalField : public FieldApplier {
public:
    void action() override;
    Real energy() const;

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(CentrifugalField, FieldApplier,
        "Centrifugal force m omega² r on the nodes of a :yref:`Membrane` about the z axis, for states of rest in a frame that turns "
        "with the spool (paper, 3.3). No Coriolis force: it does no work and vanishes at rest.",
        ((shared_ptr<Membrane>, membrane, , , "The membrane on which the field acts."))
        ((Real, omega, 0., , "Spin rate of the frame about +z [rad/s]."))
        ,
        ,
        .def("energy", &Guarded<&CentrifugalField::energy>::call, "Potential -1/2 sum m omega² r² in the present state [J].")
    );
    // clang-format on
};
REGISTER_SERIALIZABLE(CentrifugalField);

} // namespace yade
