// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "MembraneGeom.hpp"
#include "MembranePhys.hpp"
#include <core/Dispatching.hpp>

namespace yade {

class Law2_MembraneGeom_MembranePhys_Buckling : public LawFunctor {
public:
    bool go(shared_ptr<IGeom>& geom, shared_ptr<IPhys>& phys, Interaction* link) override;
    Real elasticEnergy() const;
    FUNCTOR2D(MembraneGeom, MembranePhys);
    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(Law2_MembraneGeom_MembranePhys_Buckling, LawFunctor,
        "Force of a side: linear, paper equation (3), and constant once buckled, equation (6). No torque, no shear. "
        "Of a film of plane stress only the cables are such sides. With O.trackEnergy its strain energy [J] is kept as O.energy['membraneElastic'].",
        ((int, energyIndex, -1, (Attr::hidden | Attr::noSave), "Where the energy is kept in O.energy."))
        ,
        ,
        .def("elasticEnergy", &Guarded<&Law2_MembraneGeom_MembranePhys_Buckling::elasticEnergy>::call, "Strain energy [J] of all sides in the scene.")
    );
    // clang-format on

private:
    long lookedUp_ = 0; ///< 2 (step + 1) of the last look, + 1 if bodies moved

    bool bodiesMove();
};
REGISTER_SERIALIZABLE(Law2_MembraneGeom_MembranePhys_Buckling);

} // namespace yade
