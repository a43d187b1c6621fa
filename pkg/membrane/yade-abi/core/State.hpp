// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <lib/base/Logging.hpp>
#include <lib/multimethods/Indexable.hpp>
#include <lib/serialization/Serializable.hpp>

#include <mutex>

namespace yade {

class State : public Serializable, public Indexable {
public:
    // parts of se3
    Vector3r& pos;
    Quaternionr& ori;
    std::mutex updateMutex;

    enum { DOF_NONE = 0, DOF_X = 1, DOF_Y = 2, DOF_Z = 4, DOF_RX = 8, DOF_RY = 16, DOF_RZ = 32 };
    static const unsigned DOF_ALL = DOF_X | DOF_Y | DOF_Z | DOF_RX | DOF_RY | DOF_RZ;
    static const unsigned DOF_XYZ = DOF_X | DOF_Y | DOF_Z;
    static const unsigned DOF_RXRYRZ = DOF_RX | DOF_RY | DOF_RZ;
    static unsigned axisDOF(int axis, bool rotational = false) { return 1u << (axis + (rotational ? 3 : 0)); }

    // text form: any of xyzXYZ
    string blockedDOFs_vec_get() const;
    void blockedDOFs_vec_set(const string&);
    // a component of 1 blocks
    void setDOFfromVector3r(Vector3r translations, Vector3r rotations = Vector3r::Zero());

    // since refPos and refOri
    const Vector3r displ() const;
    const Vector3r rot() const;

    const Vector3r pos_get() const;
    void pos_set(const Vector3r);
    const Quaternionr ori_get() const;
    void ori_set(const Quaternionr);

    Se3r se3;
    Vector3r vel;
    Real mass;
    Vector3r angVel;
    Vector3r angMom;
    Vector3r inertia;
    Vector3r refPos;
    Quaternionr refOri;
    unsigned blockedDOFs;
    bool isDamped;
    Real densityScaling;

    State();
    virtual ~State();
    DECLARE_LOGGER;
    YADE_ABI_SERIALIZABLE
    YADE_ABI_TOP_INDEXABLE
};

YADE_ABI_LAYOUT(
    State, 320,
    ((pos, 32))((ori, 40))((updateMutex, 48))((se3, 88))((vel, 144))((mass, 168))((angVel, 176))((angMom, 200))(
        (inertia, 224))((refPos, 248))((refOri, 272))((blockedDOFs, 304))((isDamped, 308))((densityScaling, 312)));
YADE_ABI_SAVED(State)

} // namespace yade
