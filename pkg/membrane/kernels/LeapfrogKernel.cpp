// SPDX-License-Identifier: GPL-2.0-or-later
#include "MathFlags.hpp" // like a CREATE_CPP_LOCAL_LOGGER it keeps this out of unity builds

#include "../mechanics/Drag.hpp"
#include "../mechanics/LocalDamping.hpp"
#include "BlockTransfer.hpp"
#include "LeapfrogKernel.hpp"

namespace membrane {
namespace {

/// What a block of nodes leaves for the sums.
struct Passing {
    BlockVectors own;                                          ///< forces of all channels but drag's
    BlockVectors drag, before, mean;                           ///< its force [N]; velocities [m/s]
    enum { torque, kinetic, potential, angularMomentum, all }; ///< of each node
    double of[all][blockSize];
};

inline double sumOf(const double* values, int count) {
    double sum = 0.;
#ifdef _OPENMP
#pragma omp simd reduction(+ : sum)
#endif
    for (int e = 0; e < count; ++e) sum += values[e];
    return sum;
}

/// Sum of the products of two vectors for each node; the first is set to 0, if it is no longer needed.
template <bool clear>
inline double powerOf(const Components& force, const Components& velocity, int count, double (&room)[blockSize]) {
#pragma GCC ivdep
    for (int e = 0; e < count; ++e) {
        room[e] = force.at(e).dot(velocity.at(e));
        if (clear) force.set(e, Eigen::Vector3d::Zero());
    }
    return sumOf(room, count);
}

/// Adds up the channels' forces on the nodes begin..end-1.
inline void gatherOwn(int begin, int end, const Motion& m, Passing& passing) {
    const Components sum = passing.own.components();
    bool first = true;
    for (int k = 0; k < m.channels; ++k) {
        if (!m.own[k].x) continue;
        const Components own = m.own[k] + begin;
        if (first) {
#pragma GCC ivdep
            for (int e = 0; e < end - begin; ++e) sum.set(e, own.at(e));
        } else {
#pragma GCC ivdep
            for (int e = 0; e < end - begin; ++e) sum.add(e, own.at(e));
        }
        first = false;
    }
}

template <bool drag, bool local, Sums wanted>
inline void moveBlock(int begin, int end, const Motion& m, Passing& passing) {
    constexpr bool sums = wanted != Sums::none;
    const Components x = m.x, v = m.v, u = m.u, elastic = m.elastic;
    const Components own = passing.own.components(), ofDrag = passing.drag.components();
    const Components arriving = passing.before.components(), between = passing.mean.components();
    double* const weight = m.dragWeight;
    const double* const mass = m.mass;
    const double dt = m.dt, factor = m.dragFactor, share = m.localDamping;
    const Eigen::Vector3d gravity = m.gravity;
    const double centrifugal = m.centrifugal;
#pragma GCC ivdep
    for (int i = begin; i < end; ++i) {
        const int e = i - begin;
        const Eigen::Vector3d place = x.at(i), before = v.at(i);
        Eigen::Vector3d force = elastic.at(i);
        if (drag) {
            const Eigen::Vector3d forceOfDrag = nodeDrag(factor, weight[i], u.at(i));
            force += forceOfDrag;
            weight[i] = 0.;
            if (sums) ofDrag.set(e, forceOfDrag);
        }
        if (sums) force += own.at(e);
        Eigen::Vector3d acceleration = (1. / mass[i]) * force + gravity;
        acceleration[0] += centrifugal * place[0];
        acceleration[1] += centrifugal * place[1];
        if (local)
            for (int k = 0; k < 3; ++k) acceleration[k] = locallyDamped(acceleration[k], before[k], dt, share);
        const Eigen::Vector3d after = before + dt * acceleration;
        if (sums) {
            const Eigen::Vector3d mean = 0.5 * (before + after), pull = force + mass[i] * gravity;
            between.set(e, mean);
            passing.of[Passing::torque][e] = place[0] * pull[1] - place[1] * pull[0];
            if (wanted == Sums::energies) {
                arriving.set(e, before);
                passing.of[Passing::kinetic][e] = 0.5 * mass[i] * before.dot(after);
                passing.of[Passing::potential][e] = -mass[i] * gravity.dot(place);
                passing.of[Passing::angularMomentum][e] = mass[i] * (place[0] * mean[1] - place[1] * mean[0]);
            }
        }
        elastic.set(i, Eigen::Vector3d::Zero());
        v.set(i, after);
        u.set(i, 1.5 * after - 0.5 * before);
        x.set(i, place + dt * after);
    }
}

template <bool drag, Sums wanted>
inline void addUp(int begin, int end, const Motion& m, Passing& passing, MotionSums& total) {
    const int count = end - begin;
    double room[blockSize];
    const Components before = passing.before.components(), mean = passing.mean.components();
    const auto addPowers = [&](int channel, const Components& force) {
        if (wanted == Sums::energies) total.arriving[channel] += powerOf<false>(force, before, count, room);
        total.power[channel] += powerOf<true>(force, mean, count, room);
    };
    for (int k = 0; k < m.channels; ++k)
        if (m.own[k].x) addPowers(k, m.own[k] + begin);
    if (drag) addPowers(dragChannel, passing.drag.components());
    total.torque += sumOf(passing.of[Passing::torque], count);
    if (wanted != Sums::energies) return;
    total.kinetic += sumOf(passing.of[Passing::kinetic], count);
    total.potential += sumOf(passing.of[Passing::potential], count);
    total.angularMomentum += sumOf(passing.of[Passing::angularMomentum], count);
}

template <bool drag, bool local, Sums wanted>
inline double move(int begin, int end, const Motion& m, MotionSums& total) {
    Passing passing;
    double lost = 0.; // 0 times anything finite; NaN otherwise
    for (int first = begin; first < end; first += blockSize) {
        const int last = std::min(end, first + blockSize);
        if (wanted != Sums::none) gatherOwn(first, last, m, passing);
        moveBlock<drag, local, wanted>(first, last, m, passing);
        const double *const x = m.x.x, *const y = m.x.y, *const z = m.x.z;
#ifdef _OPENMP // a YADE tree may be built without
#pragma omp simd reduction(+ : lost)
#endif
        for (int i = first; i < last; ++i) lost += 0. * (x[i] + y[i] + z[i]);
        if (wanted != Sums::none) addUp<drag, wanted>(first, last, m, passing, total);
    }
    return lost;
}

#define MEMBRANE_MOVE(name, ...)                                                                                       \
    MEMBRANE_VECTORISED double name(int begin, int end, const Motion& m, MotionSums& total) {                          \
        return move<__VA_ARGS__>(begin, end, m, total);                                                                \
    }
MEMBRANE_MOVE(freely, false, false, Sums::none)
MEMBRANE_MOVE(inAir, true, false, Sums::none)
MEMBRANE_MOVE(damped, false, true, Sums::none)
MEMBRANE_MOVE(dampedInAir, true, true, Sums::none)
MEMBRANE_MOVE(freelyWithWorks, false, false, Sums::works)
MEMBRANE_MOVE(inAirWithWorks, true, false, Sums::works)
MEMBRANE_MOVE(dampedWithWorks, false, true, Sums::works)
MEMBRANE_MOVE(dampedInAirWithWorks, true, true, Sums::works)
MEMBRANE_MOVE(freelyWithEnergies, false, false, Sums::energies)
MEMBRANE_MOVE(inAirWithEnergies, true, false, Sums::energies)
MEMBRANE_MOVE(dampedWithEnergies, false, true, Sums::energies)
MEMBRANE_MOVE(dampedInAirWithEnergies, true, true, Sums::energies)
#undef MEMBRANE_MOVE

} // namespace

void MotionSums::add(const MotionSums& more) {
    for (int k = 0; k < maxChannels; ++k) {
        power[k] += more.power[k];
        arriving[k] += more.arriving[k];
    }
    torque += more.torque;
    kinetic += more.kinetic;
    potential += more.potential;
    angularMomentum += more.angularMomentum;
}

double moveNodes(int begin, int end, const Motion& m, Sums wanted, MotionSums& sums) {
    using Move = double (*)(int, int, const Motion&, MotionSums&);
    static const Move moves[3][2][2] = {
        {{freely, inAir}, {damped, dampedInAir}},
        {{freelyWithWorks, inAirWithWorks}, {dampedWithWorks, dampedInAirWithWorks}},
        {{freelyWithEnergies, inAirWithEnergies}, {dampedWithEnergies, dampedInAirWithEnergies}}};
    const Move fitting = moves[static_cast<int>(wanted)][m.localDamping > 0.][m.dragWeight != nullptr];
    return fitting(begin, end, m, sums);
}

} // namespace membrane
