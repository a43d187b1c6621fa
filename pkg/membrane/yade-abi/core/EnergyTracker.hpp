// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <lib/base/openmp-accu.hpp>
#include <lib/serialization/Serializable.hpp>

#include <map>

namespace yade {

// Energies by name. Callers keep the index of theirs, starting with -1; a resetting one restarts from 0 in every step.
class EnergyTracker : public Serializable {
public:
    virtual ~EnergyTracker();
    void findId(const string& name, int& id, bool reset = false, bool newIfNotFound = true);
    // not from parallel sections
    void set(const Real& value, const string& name, int& id) {
        if (id < 0) findId(name, id, false);
        energies.set(size_t(id), value);
    }
    void add(const Real& value, const string& name, int& id, bool reset = false);
    Real getItem_py(const string& name);
    void setItem_py(const string& name, Real value);
    void clear();
    Real total() const;

    using mapStringInt = std::map<string, int>;
    OpenMPArrayAccumulator<Real> energies;
    mapStringInt names;
    vector<bool> resetStep;

    EnergyTracker();
    YADE_ABI_SERIALIZABLE
};

YADE_ABI_LAYOUT(EnergyTracker, 176, ((energies, 24))((names, 88))((resetStep, 136)));
YADE_ABI_SAVED(EnergyTracker)

} // namespace yade
