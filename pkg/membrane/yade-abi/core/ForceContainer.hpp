// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Body.hpp>
#include <lib/base/Logging.hpp>

#include <mutex>

namespace yade {

// Forces and torques on bodies, summed per OpenMP thread until sync().
class ForceContainer {
    using vvector = vector<Vector3r>;
    vector<vvector> _forceData;
    vector<vvector> _torqueData;
    vector<Body::id_t> _maxId;
    vector<size_t> sizeOfThreads;
    vvector _force, _torque, _permForce, _permTorque;
    size_t size;
    bool syncedSizes;
    int nThreads;
    bool permForceUsed;
    bool permForceSynced;
    std::mutex globalMutex;
    const Vector3r _zero;
    friend struct abi::Layout<ForceContainer>;

public:
    bool synced;
    unsigned long syncCount;
    long lastReset;

    ForceContainer();
    // to be called from OpenMP threads or the main one only
    void addForce(Body::id_t, const Vector3r&);
    void addTorque(Body::id_t, const Vector3r&);
    void addMaxId(Body::id_t);
    // throw unless synced
    const Vector3r& getForce(Body::id_t);
    const Vector3r& getTorque(Body::id_t);
    void sync();
    void reset(long iter, bool resetAll = false);

    // stay until set anew
    void setPermForce(Body::id_t, const Vector3r&);
    void setPermTorque(Body::id_t, const Vector3r&);
    const Vector3r& getPermForce(Body::id_t);
    const Vector3r& getPermTorque(Body::id_t);

    const Vector3r& getForceUnsynced(Body::id_t);
    const Vector3r& getTorqueUnsynced(Body::id_t);
    void addForceUnsynced(Body::id_t, const Vector3r&);
    void addTorqueUnsynced(Body::id_t, const Vector3r&);
    const Vector3r getForceSingle(Body::id_t);
    const Vector3r getTorqueSingle(Body::id_t);

    int getNumAllocatedThreads() const;
    bool getPermForceUsed() const;
    DECLARE_LOGGER;
};

YADE_ABI_LAYOUT(
    ForceContainer, 304,
    ((_forceData, 0))((_torqueData, 24))((_maxId, 48))((sizeOfThreads, 72))((_force, 96))((_torque, 120))(
        (_permForce, 144))((_permTorque, 168))((size, 192))((syncedSizes, 200))((nThreads, 204))((permForceUsed, 208))(
        (permForceSynced, 209))((globalMutex, 216))((_zero, 256))((synced, 280))((syncCount, 288))((lastReset, 296)));

} // namespace yade
