// SPDX-License-Identifier: GPL-2.0-or-later
#include "MathFlags.hpp" // like a CREATE_CPP_LOCAL_LOGGER it keeps this out of unity builds

#include "../mechanics/Drag.hpp"
#include "../mechanics/LocalDamping.hpp"
#include "LeapfrogKernel.hpp"
#include "Vectorised.hpp"

namespace membrane {
namespace {

/// What each node of a block adds to the sums.
struct Contributions {
    enum {
        power,
        torque = power + 3,
        ofWorks,
        arriving = ofWorks,
        kinetic = arriving + 3,
        potential,
        angularMomentum,
        all
    };
    double of[all][blockSize];
};

template <bool drag, bool local, Sums wanted>
inline void moveBlock(int begin, int end, const Motion& m, Contributions& added) {
    constexpr bool sums = wanted != Sums::none;
    const Components x = m.x, v = m.v, u = m.u, elastic = m.elastic, damping = m.damping, crease = m.crease;
    double* const weight = m.dragWeight;
    const double* const mass = m.mass;
    const double dt = m.dt, density = m.airDensity, share = m.localDamping;
    const Eigen::Vector3d gravity = m.gravity;
    const double centrifugal = m.centrifugal;
#pragma GCC ivdep
    for (int i = begin; i < end; ++i) {
        const Eigen::Vector3d place = x.at(i), before = v.at(i);
        Eigen::Vector3d force = elastic.at(i), forceOfDrag = Eigen::Vector3d::Zero();
        if (drag) {
            forceOfDrag = nodeDrag(density, weight[i], u.at(i));
            force += forceOfDrag;
            weight[i] = 0.;
        }
        if (sums) force += damping.at(i) + crease.at(i);
        Eigen::Vector3d acceleration = (1. / mass[i]) * force + gravity;
        acceleration[0] += centrifugal * place[0];
        acceleration[1] += centrifugal * place[1];
        if (local)
            for (int k = 0; k < 3; ++k) acceleration[k] = locallyDamped(acceleration[k], before[k], dt, share);
        const Eigen::Vector3d after = before + dt * acceleration;
        if (sums) {
            const int e = i - begin;
            const Eigen::Vector3d mean = 0.5 * (before + after), pull = force + mass[i] * gravity;
            added.of[Contributions::power][e] = crease.at(i).dot(mean);
            added.of[Contributions::power + 1][e] = damping.at(i).dot(mean);
            added.of[Contributions::power + 2][e] = forceOfDrag.dot(mean);
            added.of[Contributions::torque][e] = place[0] * pull[1] - place[1] * pull[0];
            if (wanted == Sums::energies) {
                added.of[Contributions::arriving][e] = crease.at(i).dot(before);
                added.of[Contributions::arriving + 1][e] = damping.at(i).dot(before);
                added.of[Contributions::arriving + 2][e] = forceOfDrag.dot(before);
                added.of[Contributions::kinetic][e] = 0.5 * mass[i] * before.dot(after);
                added.of[Contributions::potential][e] = -mass[i] * gravity.dot(place);
                added.of[Contributions::angularMomentum][e] = mass[i] * (place[0] * mean[1] - place[1] * mean[0]);
            }
            damping.set(i, Eigen::Vector3d::Zero());
            crease.set(i, Eigen::Vector3d::Zero());
        }
        elastic.set(i, Eigen::Vector3d::Zero());
        v.set(i, after);
        u.set(i, 1.5 * after - 0.5 * before);
        x.set(i, place + dt * after);
    }
}

template <bool drag, bool local, Sums wanted>
inline double move(int begin, int end, const Motion& m, MotionSums& total) {
    Contributions added;
    double lost = 0.; // 0 times anything finite; NaN otherwise
    for (int first = begin; first < end; first += blockSize) {
        const int last = std::min(end, first + blockSize);
        moveBlock<drag, local, wanted>(first, last, m, added);
        const double *const x = m.x.x, *const y = m.x.y, *const z = m.x.z;
#ifdef _OPENMP // a YADE tree may be built without
#pragma omp simd reduction(+ : lost)
#endif
        for (int i = first; i < last; ++i) lost += 0. * (x[i] + y[i] + z[i]);
        if (wanted == Sums::none) continue;
        constexpr int count = wanted == Sums::energies ? Contributions::all : Contributions::ofWorks;
        double sum[count];
        for (int k = 0; k < count; ++k) {
            double part = 0.;
#ifdef _OPENMP
#pragma omp simd reduction(+ : part)
#endif
            for (int e = 0; e < last - first; ++e) part += added.of[k][e];
            sum[k] = part;
        }
        for (int k = 0; k < 3; ++k) total.power[k] += sum[Contributions::power + k];
        total.torque += sum[Contributions::torque];
        if (wanted != Sums::energies) continue;
        for (int k = 0; k < 3; ++k) total.arriving[k] += sum[Contributions::arriving + k];
        total.kinetic += sum[Contributions::kinetic];
        total.potential += sum[Contributions::potential];
        total.angularMomentum += sum[Contributions::angularMomentum];
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
