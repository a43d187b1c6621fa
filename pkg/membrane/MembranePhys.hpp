// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "Membrane.hpp"
#include <core/Dispatching.hpp>
#include <lib/factory/ClassFactory.hpp>
#include <pkg/common/NormShearPhys.hpp>

namespace yade {

/// Spring of one side. A NormShearPhys, since YADE's own analyses take every interaction for one.
class MembranePhys : public NormShearPhys {
public:
    long computed = -1; ///< step in which the law last computed the side's force; -1: none yet
    long checked = -1;  ///< step in which an engine of the membrane last asked for that; -1: none yet

    explicit MembranePhys(const ::membrane::Side& side) : MembranePhys() { set(side); }
    void set(const ::membrane::Side& side) {
        kn = side.stiffness;
        restLength = side.restLength;
        criticalLength = side.critical;
    }
    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR(MembranePhys, NormShearPhys,
        "Spring of one side of a :yref:`Membrane`: stiffness :yref:`kn<NormPhys.kn>` k [N/m] and the lengths of paper equations (3), (6). "
        ":yref:`normalForce<NormPhys.normalForce>` [N] follows YADE: along the normal in compression, against it in tension.",
        ((Real, unusedFriction, 0., (Attr::hidden | Attr::noSave), "Not used [-]. It lies where YADE's setContactFriction, which takes every interaction for a FrictPhys, writes."))
        ((Real, restLength, 0., , "Rest length L0 [m]."))
        ((Real, criticalLength, 0., , "Length l_cr [m] below which the side is buckled and its force constant."))
        ,
        // No shear, but YADE's energy helpers divide by ks; one so small does not weigh in its time steppers.
        ks = 1e-200;
        createIndex();
    );
    // clang-format on
    REGISTER_CLASS_INDEX(MembranePhys, NormShearPhys);
};
REGISTER_SERIALIZABLE(MembranePhys);

class Ip2_MembraneMat_MembraneMat_MembranePhys : public IPhysFunctor {
public:
    void go(const shared_ptr<Material>&, const shared_ptr<Material>&, const shared_ptr<Interaction>& link) override;
    FUNCTOR2D(MembraneMat, MembraneMat);
    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR(Ip2_MembraneMat_MembraneMat_MembranePhys, IPhysFunctor,
        "Gives a side of a membrane its spring; sides made by :yref:`Membrane.addInteractions` have it already. Two bodies of film's material that are no "
        "side, such as a node and a grain, are left to `contact`.",
        ((shared_ptr<Membrane>, membrane, , , "Not needed: a node knows its membrane. Kept for scripts that give it."))
        ((shared_ptr<IPhysFunctor>, contact, , , "What gives contacts of two such bodies their physics; default: YADE's Ip2_FrictMat_FrictMat_FrictPhys."))
        ,
        ordinaryContact_ = boost::dynamic_pointer_cast<IPhysFunctor>(ClassFactory::instance().createShared("Ip2_FrictMat_FrictMat_FrictPhys"));
    );
    // clang-format on

private:
    shared_ptr<IPhysFunctor> ordinaryContact_;
};
REGISTER_SERIALIZABLE(Ip2_MembraneMat_MembraneMat_MembranePhys);

} // namespace yade
