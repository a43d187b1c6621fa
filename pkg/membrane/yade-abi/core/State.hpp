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

    // one bit per blocked degree of freedom: translations first, then rotations
    enum {
        DOF_NONE = 0,
        DOF_X = 1 << 0,
        DOF_Y = 1 << 1,
        DOF_Z = 1 << 2,
        DOF_RX = 1 << 3,
        DOF_RY = 1 << 4,
        DOF_RZ = 1 << 5
    };
    static const unsigned DOF_XYZ = 0x07;
    static const unsigned DOF_RXRYRZ = 0x38;
    static const unsigned DOF_ALL = DOF_XYZ | DOF_RXRYRZ;
    static unsigned axisDOF(int axis, bool rotational = false) { return (rotational ? DOF_RX : DOF_X) << axis; }

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
