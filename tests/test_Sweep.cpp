// SPDX-License-Identifier: GPL-2.0-or-later
// All forces, energies and the leapfrog in one sweep, against plain loops over the functions of the mechanics.
#include "pkg/membrane/kernels/CreaseKernel.hpp"
#include "pkg/membrane/kernels/DragKernel.hpp"
#include "pkg/membrane/kernels/SideKernel.hpp"
#include "pkg/membrane/kernels/Sweep.hpp"
#include "pkg/membrane/mechanics/Damping.hpp"
#include "pkg/membrane/mechanics/Drag.hpp"
#include "pkg/membrane/mechanics/SideForce.hpp"
#include "shapes.hpp"
#include <gtest/gtest.h>
#include <limits>
#include <numeric>

using namespace membrane;
using shapes::Vector3d;

namespace {

constexpr double dt = 1e-6;
const int partCounts[] = {1, 2, 3, 5};
const int chunkSizes[] = {1, 7, 64, 512};

/// Which forces act, besides those of the sides.
struct Laws {
    std::vector<double> damping; ///< c of each side [N s/m]; empty: none
    CreaseLaw crease;            ///< bending = 0: none
    double airDensity = 0.;      ///< [kg/m³]; 0: none
};

/// A sheet in motion, with everything that can act on it.
struct Model {
    MeshInput in;
    RestState rest;
    Laws laws;
    std::vector<char> owned;
    Points x, v;

    /// \param strain moves the nodes by up to this share of a cell
    Model(int nx, int ny, double disorder, bool mixedNumbers, double strain = 0.02) {
        in = shapes::sheet(nx, ny, disorder, 5, true);
        in.alpha = 1e4; // sides buckle at strains between 0 and about 0.01
        in.cableStiffness = 300.;
        in.cableDensity = 1e-3;
        const auto node = [nx](int i, int j) { return j * (nx + 1) + i; };
        for (int j = 0; j + 3 <= ny; j += 2)
            for (int i = 0; i + 1 <= nx; i += 3) in.cables.emplace_back(node(i, j), node(i + 1, j + 3));
        if (mixedNumbers) renumber();
        rest = restState(in);
        shapes::Random random(7);
        for (const Vector3d& p : in.nodes) {
            x.push_back(p + random.vector(0.1 * strain));
            v.push_back(random.vector(100.));
        }
        owned.assign(x.size(), true);
    }

    void renumber() {
        std::vector<int> number(in.nodes.size());
        std::iota(number.begin(), number.end(), 0);
        std::shuffle(number.begin(), number.end(), std::mt19937(9));
        Points nodes(in.nodes.size());
        for (std::size_t i = 0; i < nodes.size(); ++i) nodes[number[i]] = in.nodes[i];
        in.nodes = nodes;
        for (auto& t : in.triangles)
            for (int k = 0; k < 3; ++k) t[k] = number[t[k]];
        for (auto* pairs : {&in.creases, &in.cables})
            for (auto& pair : *pairs)
                for (int k = 0; k < 2; ++k) pair[k] = number[pair[k]];
    }

    Model& withDamping(double zeta = 0.05) {
        laws.damping.clear();
        for (const Side& s : rest.sides)
            laws.damping.push_back(dampingCoefficient(zeta, s.stiffness, 0.5 * (rest.masses[s.a] + rest.masses[s.b])));
        return *this;
    }
    Model& withCreases(bool conservative) {
        laws.crease = {2., 100., 0.3, conservative};
        return *this;
    }
    Model& withDrag() {
        laws.airDensity = 5.;
        return *this;
    }
    /// Every fourth node, and a run of others, is moved by somebody else.
    Model& withForeign() {
        for (std::size_t i = 0; i < owned.size(); ++i) owned[i] = i % 4 != 1 && (i < 10 || i > 17);
        return *this;
    }
    Model& withAll(bool conservative = false) { return withDamping().withCreases(conservative).withDrag(); }

    ElementForces forces() const {
        ElementForces all{std::make_shared<SideForces>(rest, laws.damping)};
        if (laws.crease.bending > 0.) all.push_back(std::make_shared<CreaseForce>(rest, laws.crease));
        if (laws.airDensity > 0.) all.push_back(std::make_shared<DragForce>(in.triangles, laws.airDensity));
        return all;
    }

    Sweep sweep(int parts = 1, int chunkSize = 512) const {
        Sweep made;
        made.prepare(forces(), rest.masses, owned, parts, chunkSize);
        for (std::size_t i = 0; i < x.size(); ++i) {
            made.x.set(i, x[i]);
            made.v.set(i, v[i]);
            made.u.set(i, v[i]);
        }
        return made;
    }
};

/// The same membrane in plain loops.
struct Plain {
    const Model& model;
    Points x, v, u;
    Points elastic, damping, crease, drag;
    std::vector<double> lengths;
    GroupEnergy energy;
    MotionSums sums;

    explicit Plain(const Model& m) : model(m), x(m.x), v(m.v), u(m.v) {}

    Vector3d force(int i) const { return elastic[i] + damping[i] + crease[i] + drag[i]; }

    void computeForces() {
        const RestState& rest = model.rest;
        elastic.assign(x.size(), Vector3d::Zero());
        damping = crease = drag = elastic;
        energy = {};
        const std::vector<double> before = lengths;
        lengths.clear();
        for (std::size_t i = 0; i < rest.sides.size(); ++i) {
            const Side& s = rest.sides[i];
            const Vector3d span = x[s.b] - x[s.a];
            const double length = span.norm();
            lengths.push_back(length);
            energy.elastic += sideEnergy(length, s.stiffness, s.restLength, s.critical);
            if (!before.empty()) energy.kink += kinkEnergy(before[i], length, s.stiffness, s.critical);
            const bool cable = s.kind == SideKind::cable;
            if (length == 0. || (cable && length <= s.restLength)) continue;
            const double tension = sideTension(length, s.stiffness, s.restLength, s.critical);
            elastic[s.a] += tension * span / length;
            elastic[s.b] -= tension * span / length;
            if (model.laws.damping.empty()) continue;
            const double rate = (u[s.b] - u[s.a]).dot(span) / length, c = model.laws.damping[i];
            const double brake = cable ? cableDamping(c, rate, tension) : c * rate;
            damping[s.a] += brake * span / length;
            damping[s.b] -= brake * span / length;
        }
        if (model.laws.crease.bending > 0.)
            for (const Crease& c : rest.creases) {
                const CreaseState state = creaseState(c.rest, x[c.a], x[c.b], x[c.c], x[c.d]);
                const CreaseForces f = creaseForces(c.rest, model.laws.crease, state);
                crease[c.a] += f.a;
                crease[c.b] += f.b;
                crease[c.c] += f.c;
                crease[c.d] += f.d;
            }
        for (const Eigen::Vector3i& t : model.in.triangles) {
            const Vector3d area = (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]);
            for (int k = 0; k < 3; ++k) drag[t[k]] += cornerDrag(model.laws.airDensity, area, u[t[k]]);
        }
    }

    /// Moves the nodes that are owned.
    void move(const SweepStep& now) {
        sums = {};
        for (std::size_t i = 0; i < x.size(); ++i) {
            if (!model.owned[i]) continue;
            const double m = model.rest.masses[i];
            Vector3d acceleration = force(i) / m + now.gravity;
            for (int k = 0; k < 3; ++k) // as NewtonIntegrator::cundallDamp2nd
                if (acceleration[k] * (v[i][k] + 0.5 * now.dt * acceleration[k]) > 0.)
                    acceleration[k] *= 1. - now.localDamping;
                else if (acceleration[k] * (v[i][k] + 0.5 * now.dt * acceleration[k]) < 0.)
                    acceleration[k] *= 1. + now.localDamping;
            const Vector3d before = v[i], after = before + now.dt * acceleration, mean = 0.5 * (before + after);
            sums.kinetic += 0.5 * m * before.dot(after);
            sums.potential -= m * now.gravity.dot(x[i]);
            sums.angularMomentum += m * x[i].cross(mean)[2];
            sums.torque += x[i].cross(force(i) + m * now.gravity)[2];
            const Vector3d parts[] = {crease[i], damping[i], drag[i]};
            for (int k = 0; k < 3; ++k) {
                sums.arriving[k] += parts[k].dot(before);
                sums.power[k] += parts[k].dot(mean);
            }
            v[i] = after;
            u[i] = 1.5 * after - 0.5 * before;
            x[i] += now.dt * after;
        }
    }
};

double largest(const Points& vectors) {
    double most = 0.;
    for (const Vector3d& f : vectors) most = std::max(most, f.norm());
    return most;
}

/// Largest difference over the largest of what is expected.
template <class Get> double difference(const Points& expected, Get get) {
    double most = 0.;
    for (std::size_t i = 0; i < expected.size(); ++i) most = std::max(most, (get(i) - expected[i]).norm());
    return most / std::max(largest(expected), 1e-300);
}

double relative(double found, double expected) {
    return std::abs(found - expected) / std::max(std::abs(expected), 1e-300);
}

SweepStep still(bool apart = false, Sums sums = Sums::none) {
    SweepStep now;
    now.dt = dt;
    now.move = false;
    now.apart = apart;
    now.sums = sums;
    return now;
}

constexpr Sums allSums[] = {Sums::none, Sums::works, Sums::energies};

SweepStep moving(Sums sums = Sums::none) {
    SweepStep now = still(sums != Sums::none, sums);
    now.move = true;
    return now;
}

bool sameBits(const Sweep& one, const Sweep& other) {
    return one.x.x == other.x.x && one.x.y == other.x.y && one.x.z == other.x.z && one.v.x == other.v.x &&
           one.v.y == other.v.y && one.v.z == other.v.z && one.u.x == other.u.x && one.u.y == other.u.y &&
           one.u.z == other.u.z;
}

/// Sheets with ordered and with mixed numbers, under each force and under all.
std::vector<Model> models() {
    std::vector<Model> all;
    for (bool mixed : {false, true}) {
        const Model bare(13, 11, 0.01, mixed);
        for (int which = 0; which < 6; ++which) {
            all.push_back(bare);
            Model& m = all.back();
            if (which == 1) m.withDamping();
            if (which == 2) m.withCreases(false);
            if (which == 3) m.withCreases(true);
            if (which == 4) m.withDrag();
            if (which == 5) m.withAll(mixed).withForeign();
        }
    }
    return all;
}

// ---------------------------------------------------------------------------------------------------------------------

TEST(Sweep, ModelHasSidesInEveryState) {
    // Otherwise the tests below would compare less than they claim.
    const Model m(13, 11, 0.01, false);
    int slack = 0, taut = 0, buckled = 0, stretched = 0, pressed = 0;
    for (const Side& s : m.rest.sides) {
        const double length = (m.x[s.b] - m.x[s.a]).norm();
        if (s.kind == SideKind::cable)
            ++(length > s.restLength ? taut : slack);
        else
            ++(length > s.restLength ? stretched : length > s.critical ? pressed : buckled);
    }
    for (int count : {slack, taut}) EXPECT_GT(count, 5);
    for (int count : {buckled, stretched, pressed}) EXPECT_GT(count, 30);
    EXPECT_GT(m.rest.creases.size(), 50u);
}

TEST(Sweep, ForcesAreThoseOfPlainLoops) {
    for (const Model& m : models()) {
        Plain plain(m);
        plain.computeForces();
        Points total;
        for (std::size_t i = 0; i < m.x.size(); ++i) total.push_back(plain.force(i));
        for (int parts : partCounts)
            for (int chunkSize : chunkSizes) {
                SCOPED_TRACE(testing::Message() << parts << " parts, chunks of " << chunkSize);
                Sweep sweep = m.sweep(parts, chunkSize);
                ASSERT_TRUE(sweep.step(still()));
                EXPECT_LT(difference(total, [&](int i) { return sweep.force(i); }), 1e-12);
                for (int times : {1, 2}) { // nothing is left of the step before
                    ASSERT_TRUE(sweep.step(still(true))) << times;
                    EXPECT_LT(difference(total, [&](int i) { return sweep.force(i); }), 1e-12);
                    EXPECT_LT(difference(plain.elastic, [&](int i) { return sweep.elasticForce(i); }), 1e-12);
                    EXPECT_LT(difference(plain.damping, [&](int i) { return sweep.channelForce(dampingChannel, i); }),
                              1e-12);
                    EXPECT_LT(difference(plain.crease, [&](int i) { return sweep.channelForce(creaseChannel, i); }),
                              1e-12);
                    EXPECT_LT(difference(plain.drag, [&](int i) { return sweep.channelForce(dragChannel, i); }), 1e-12);
                }
            }
    }
}

TEST(Sweep, WithoutSpringsOnlyTheOtherForcesAreLeft) {
    const Model m = Model(13, 11, 0.01, false).withAll();
    Plain plain(m);
    plain.computeForces();
    SweepStep now = still(true);
    now.elastic = false;
    for (int parts : partCounts) {
        Sweep sweep = m.sweep(parts, 64);
        sweep.step(now);
        for (std::size_t i = 0; i < m.x.size(); ++i) EXPECT_EQ(sweep.elasticForce(i), Vector3d::Zero());
        EXPECT_LT(difference(plain.damping, [&](int i) { return sweep.channelForce(dampingChannel, i); }), 1e-12);
        EXPECT_LT(difference(plain.crease, [&](int i) { return sweep.channelForce(creaseChannel, i); }), 1e-12);
        EXPECT_LT(difference(plain.drag, [&](int i) { return sweep.channelForce(dragChannel, i); }), 1e-12);
    }
}

TEST(Sweep, EnergiesKinksAndSumsAreThoseOfPlainLoops) {
    for (const Model& m : models()) {
        for (int parts : partCounts)
            for (int chunkSize : chunkSizes) {
                SCOPED_TRACE(testing::Message() << parts << " parts, chunks of " << chunkSize);
                Plain plain(m);
                plain.lengths.clear();
                for (const Side& s : m.rest.sides) // where the nodes were a step ago, as far as is known
                    plain.lengths.push_back(((m.x[s.b] - dt * m.v[s.b]) - (m.x[s.a] - dt * m.v[s.a])).norm());
                Sweep sweep = m.sweep(parts, chunkSize);
                EXPECT_TRUE(sweep.memory().empty());
                SweepStep now = moving(Sums::energies);
                now.gravity = Vector3d(3., -2., 9.81);
                for (int step = 0; step < 3; ++step) {
                    plain.computeForces();
                    plain.move(now);
                    ASSERT_TRUE(sweep.step(now));
                    const MotionSums& sums = sweep.motionSums();
                    EXPECT_LT(relative(sweep.elementEnergies().elastic, plain.energy.elastic), 1e-11);
                    EXPECT_GT(std::abs(plain.energy.kink), 1e-8 * plain.energy.elastic) << "no side has a kink";
                    EXPECT_LT(relative(sweep.elementEnergies().kink, plain.energy.kink), 1e-8);
                    EXPECT_LT(relative(sums.kinetic, plain.sums.kinetic), 1e-12);
                    EXPECT_LT(relative(sums.potential, plain.sums.potential), 1e-12);
                    EXPECT_LT(relative(sums.angularMomentum, plain.sums.angularMomentum), 1e-10);
                    EXPECT_LT(relative(sums.torque, plain.sums.torque), 1e-9);
                    for (int k = 0; k < 3; ++k) {
                        EXPECT_LT(relative(sums.arriving[k], plain.sums.arriving[k]), 1e-10) << k;
                        EXPECT_LT(relative(sums.power[k], plain.sums.power[k]), 1e-10) << k;
                    }
                    const std::vector<double> lengths = sweep.memory();
                    ASSERT_EQ(lengths.size(), plain.lengths.size());
                    for (std::size_t i = 0; i < lengths.size(); ++i)
                        EXPECT_LT(relative(lengths[i], plain.lengths[i]), 1e-12);
                }
            }
    }
}

TEST(Sweep, GivenLengthsAreThoseFromWhichKinksAreCounted) {
    const Model m(13, 11, 0.01, false);
    for (int parts : {1, 3}) {
        Plain plain(m);
        shapes::Random random(3);
        for (const Side& s : m.rest.sides) plain.lengths.push_back(s.critical * random.between(0.99, 1.01));
        Sweep sweep = m.sweep(parts, 64);
        sweep.setMemory(plain.lengths);
        const std::vector<double> kept = sweep.memory();
        EXPECT_EQ(kept, plain.lengths);
        plain.computeForces();
        sweep.step(still(true, Sums::energies));
        EXPECT_LT(relative(sweep.elementEnergies().kink, plain.energy.kink), 1e-11);
        sweep.step(still()); // no sums: the lengths are no longer those of the step before
        EXPECT_FALSE(sweep.remembers());
        EXPECT_TRUE(sweep.memory().empty());
    }
}

TEST(Sweep, StepsAreThoseOfAPlainLeapfrog) {
    for (const Model& m : models()) {
        for (Sums sums : allSums)
            for (double localDamping : {0., 0.4}) {
                Plain plain(m);
                SweepStep now = moving(sums);
                now.gravity = Vector3d(30., -20., 90.81);
                now.localDamping = localDamping;
                for (int step = 0; step < 6; ++step) {
                    plain.computeForces();
                    plain.move(now);
                }
                const double moved = difference(m.x, [&](int i) { return plain.x[i]; });
                EXPECT_GT(moved, 3e-5);
                for (int which = 0; which < 4; ++which) {
                    const int parts = partCounts[which], chunkSize = chunkSizes[(which + 2) % 4];
                    SCOPED_TRACE(testing::Message() << parts << " parts, chunks of " << chunkSize);
                    Sweep sweep = m.sweep(parts, chunkSize);
                    for (int step = 0; step < 6; ++step) ASSERT_TRUE(sweep.step(now));
                    EXPECT_LT(difference(plain.x, [&](int i) { return sweep.x.at(i); }), 1e-13);
                    EXPECT_LT(difference(plain.v, [&](int i) { return sweep.v.at(i); }), 1e-11);
                    EXPECT_LT(difference(plain.u, [&](int i) { return sweep.u.at(i); }), 1e-11);
                }
            }
    }
}

TEST(Sweep, NodesOfOthersStayWithTheRightForceOnThem) {
    for (bool mixed : {false, true})
        for (Sums sums : allSums) {
            const Model m = Model(13, 11, 0.01, mixed).withAll().withForeign();
            for (int parts : partCounts)
                for (int chunkSize : chunkSizes) {
                    Plain plain(m);
                    Sweep sweep = m.sweep(parts, chunkSize);
                    for (int step = 0; step < 3; ++step) {
                        plain.computeForces();
                        ASSERT_TRUE(sweep.step(moving(sums)));
                        const double size = largest(plain.elastic);
                        for (std::size_t i = 0; i < m.x.size(); ++i) {
                            if (m.owned[i]) continue;
                            EXPECT_EQ(sweep.x.at(i), m.x[i]);
                            EXPECT_EQ(sweep.v.at(i), m.v[i]);
                            EXPECT_LT((sweep.force(i) - plain.force(i)).norm(), 1e-11 * size);
                            if (sums == Sums::none) continue;
                            EXPECT_LT((sweep.elasticForce(i) - plain.elastic[i]).norm(), 1e-11 * size);
                        }
                        plain.move(moving(sums));
                    }
                }
        }
}

TEST(Sweep, WorksAreTheSameBitsWithAndWithoutEnergies) {
    for (bool mixed : {false, true})
        for (int parts : partCounts) {
            const Model m = Model(13, 11, 0.01, mixed).withAll().withForeign();
            Sweep works = m.sweep(parts, 64), energies = m.sweep(parts, 64);
            for (int step = 0; step < 4; ++step) {
                ASSERT_TRUE(works.step(moving(Sums::works)));
                ASSERT_TRUE(energies.step(moving(Sums::energies)));
                EXPECT_TRUE(sameBits(works, energies));
                const MotionSums &one = works.motionSums(), &other = energies.motionSums();
                for (int k = 0; k < 3; ++k) {
                    EXPECT_NE(one.power[k], 0.);
                    EXPECT_EQ(one.power[k], other.power[k]);
                }
                EXPECT_EQ(one.torque, other.torque);
                EXPECT_NE(works.elementEnergies().kink, 0.);
                EXPECT_EQ(works.elementEnergies().kink, energies.elementEnergies().kink);
            }
        }
}

TEST(Sweep, SamePartsGiveTheSameBitsAndOthersNearlyTheSame) {
    for (bool mixed : {false, true}) {
        const Model m = Model(30, 25, 0.01, mixed).withAll();
        const auto run = [&m](int parts) {
            Sweep sweep = m.sweep(parts, 64);
            for (int step = 0; step < 10; ++step) sweep.step(moving(allSums[step % 3]));
            return sweep;
        };
        const Sweep alone = run(1);
        for (int parts : partCounts) {
            const Sweep one = run(parts), other = run(parts);
            EXPECT_TRUE(sameBits(one, other)) << parts;
            EXPECT_EQ(one.motionSums().kinetic, other.motionSums().kinetic);
            EXPECT_EQ(one.elementEnergies().elastic, other.elementEnergies().elastic);
            EXPECT_LT(difference(alone.x.points(), [&](int i) { return one.x.at(i); }), 1e-13);
            EXPECT_LT(difference(alone.v.points(), [&](int i) { return one.v.at(i); }), 1e-12);
        }
        EXPECT_FALSE(sameBits(alone, run(5))) << "parts seem to be ignored";
    }
}

TEST(Sweep, LargeSheetInManyChunks) {
    // So many nodes that the work on a chunk fetches the next one.
    const Model m = Model(110, 90, 0.01, false).withAll();
    Plain plain(m);
    for (int step = 0; step < 3; ++step) {
        plain.computeForces();
        plain.move(moving());
    }
    for (int parts : {1, 2, 5}) {
        Sweep sweep = m.sweep(parts);
        for (int step = 0; step < 3; ++step) ASSERT_TRUE(sweep.step(moving(step == 1 ? Sums::energies : Sums::none)));
        EXPECT_LT(difference(plain.x, [&](int i) { return sweep.x.at(i); }), 1e-13);
        EXPECT_LT(difference(plain.v, [&](int i) { return sweep.v.at(i); }), 1e-12);
    }
}

TEST(Sweep, MorePartsThanNodes) {
    const Model m = Model(2, 1, 0.01, false).withAll();
    Plain plain(m);
    plain.computeForces();
    plain.move(moving());
    for (int parts : {6, 7, 20}) {
        Sweep sweep = m.sweep(parts, 2);
        ASSERT_TRUE(sweep.step(moving()));
        EXPECT_LT(difference(plain.x, [&](int i) { return sweep.x.at(i); }), 1e-13);
    }
}

TEST(Sweep, StepWithoutMotionMovesNothingAndIsNotCountedInTheNext) {
    for (Sums sums : allSums) {
        const Model m = Model(13, 11, 0.01, false).withAll().withForeign();
        for (int parts : partCounts) {
            Sweep straight = m.sweep(parts, 64), interrupted = m.sweep(parts, 64);
            for (int step = 0; step < 4; ++step) {
                const Sweep before = interrupted;
                for (int times = 0; times < 2; ++times) ASSERT_TRUE(interrupted.step(still(sums != Sums::none, sums)));
                EXPECT_TRUE(sameBits(before, interrupted));
                ASSERT_TRUE(straight.step(moving(sums)));
                ASSERT_TRUE(interrupted.step(moving(sums)));
                EXPECT_TRUE(sameBits(straight, interrupted)) << "step " << step;
                for (std::size_t i = 0; i < m.x.size(); ++i) {
                    if (m.owned[i]) continue;
                    EXPECT_EQ(straight.force(i), interrupted.force(i));
                }
            }
        }
    }
}

TEST(Sweep, ForcesFromOutsideActOnceAStepUntilTheyAreTakenAway) {
    const Model m(5, 4, 0.01, false, 0.);
    const Vector3d push(3., 4., 5.);
    for (int parts : partCounts) {
        Sweep sweep = m.sweep(parts, 7);
        for (std::size_t i = 0; i < m.x.size(); ++i) {
            sweep.v.set(i, Vector3d::Zero());
            sweep.u.set(i, Vector3d::Zero());
        }
        sweep.outside = {{0, push}, {12, -push}, {29, push}};
        sweep.step(still());
        EXPECT_LT((sweep.force(12) + push).norm(), 1e-6);
        sweep.step(moving()); // the sheet is flat and at rest: nothing else acts
        EXPECT_LT((sweep.v.at(0) - dt * push / m.rest.masses[0]).norm(), 1e-9 * sweep.v.at(0).norm());
        EXPECT_LT((sweep.v.at(12) + dt * push / m.rest.masses[12]).norm(), 1e-9 * sweep.v.at(12).norm());
        EXPECT_LT((sweep.v.at(29) - dt * push / m.rest.masses[29]).norm(), 1e-9 * sweep.v.at(29).norm());
        EXPECT_LT(sweep.v.at(7).norm(), 1e-9);
        sweep.outside.clear();
        for (std::size_t i = 0; i < m.x.size(); ++i) {
            sweep.x.set(i, m.x[i]);
            sweep.v.set(i, Vector3d::Zero());
        }
        sweep.step(moving());
        for (std::size_t i = 0; i < m.x.size(); ++i) EXPECT_LT(sweep.v.at(i).norm(), 1e-6);
    }
}

TEST(Sweep, PreparedAnewItKeepsItsStateAndTakesTheNewLaws) {
    Model m = Model(13, 11, 0.01, false).withAll();
    Sweep sweep = m.sweep(2, 64);
    for (int step = 0; step < 3; ++step) sweep.step(moving(Sums::energies));
    const Points x = sweep.x.points(), v = sweep.v.points(), u = sweep.u.points();
    m.laws = Laws();
    m.withDamping(0.2);
    sweep.prepare(m.forces(), m.rest.masses, m.owned, 3, 7);
    EXPECT_EQ(sweep.x.points(), x);
    EXPECT_EQ(sweep.v.points(), v);
    EXPECT_EQ(sweep.u.points(), u);
    Plain plain(m);
    plain.x = x, plain.v = v, plain.u = u;
    plain.computeForces();
    sweep.step(still(true));
    EXPECT_LT(difference(plain.elastic, [&](int i) { return sweep.elasticForce(i); }), 1e-12);
    EXPECT_LT(difference(plain.damping, [&](int i) { return sweep.channelForce(dampingChannel, i); }), 1e-12);
    for (std::size_t i = 0; i < x.size(); ++i) {
        EXPECT_EQ(sweep.channelForce(creaseChannel, i), Vector3d::Zero());
        EXPECT_EQ(sweep.channelForce(dragChannel, i), Vector3d::Zero());
    }
}

// ---------------------------------------------------------------------------------------------------------------------
// Likeness of sides

TEST(Sweep, SharedConstantsOfARegularSheetChangeNoForce) {
    // Lengths of a regular mesh differ in their last digits, here by about a quarter of what counts as alike.
    Model m(400, 6, 0., false);
    m.laws.damping.assign(m.rest.sides.size(), 3.);
    shapes::Random random(2);
    for (std::size_t i = 0; i < m.rest.sides.size(); ++i) {
        Side& s = m.rest.sides[i];
        for (double* constant : {&s.restLength, &s.stiffness, &s.critical, &m.laws.damping[i]})
            *constant *= 1. + random.between(-1e-13, 1e-13);
    }
    SideForces sides(m.rest, m.laws.damping);
    sides.arrange(partition(static_cast<int>(m.x.size()), 1, 512));
    EXPECT_LT(sides.constantCount(), 3 * sides.order().size() / 4) << "nothing is shared";
    Plain plain(m);
    plain.computeForces();
    Sweep sweep = m.sweep();
    sweep.step(still(true));
    EXPECT_LT(difference(plain.elastic, [&](int i) { return sweep.elasticForce(i); }), 1e-9);
    EXPECT_LT(difference(plain.damping, [&](int i) { return sweep.channelForce(dampingChannel, i); }), 1e-9);
}

TEST(Sweep, SidesThatDifferABitMoreKeepTheirOwnConstants) {
    for (int which : {0, 1, 2, 3}) {
        Model m = Model(400, 6, 0., false).withDamping();
        shapes::Random random(2);
        for (std::size_t i = 0; i < m.rest.sides.size(); ++i) {
            Side& s = m.rest.sides[i];
            double* const constants[] = {&s.stiffness, &s.restLength, &s.critical, &m.laws.damping[i]};
            *constants[which] *= 1. + random.between(-1e-4, 1e-4);
        }
        Plain plain(m);
        plain.computeForces();
        Sweep sweep = m.sweep();
        sweep.step(still(true));
        EXPECT_LT(difference(plain.elastic, [&](int i) { return sweep.elasticForce(i); }), 1e-12) << which;
        EXPECT_LT(difference(plain.damping, [&](int i) { return sweep.channelForce(dampingChannel, i); }), 1e-12)
            << which;
    }
}

TEST(Sweep, OneOtherSideAmongManyAlikeKeepsItsOwnConstants) {
    for (std::size_t odd = 0; odd < 4000; odd += 93) {
        Model m(400, 3, 0., false);
        m.rest.sides[odd].stiffness *= 1.1;
        Plain plain(m);
        plain.computeForces();
        Sweep sweep = m.sweep();
        sweep.step(still());
        EXPECT_LT(difference(plain.elastic, [&](int i) { return sweep.force(i); }), 1e-11) << odd;
    }
}

// ---------------------------------------------------------------------------------------------------------------------
// Degenerate states

TEST(Sweep, CoincidingNodesAndCollapsedElementsGiveFiniteNumbers) {
    for (bool conservative : {false, true}) {
        for (int parts : partCounts) {
            const Model m = Model(13, 11, 0.01, false).withAll(conservative);
            Sweep sweep = m.sweep(parts, 64);
            for (int i = 0; i < 40; ++i) sweep.x.set(i, m.x[0]);                      // sides, triangles, creases
            for (int i = 60; i < 80; ++i) sweep.x.set(i, m.x[60] + (i % 3) * m.x[1]); // on a line
            for (int i = 100; i < 168; ++i) sweep.x.set(i, m.x[100] + 1e-9 * m.x[i]); // nearly
            Plain plain(m);
            plain.x = sweep.x.points();
            plain.computeForces();
            ASSERT_TRUE(sweep.step(still(true, Sums::energies)));
            for (std::size_t i = 0; i < m.x.size(); ++i) EXPECT_TRUE(sweep.force(i).allFinite()) << i;
            EXPECT_LT(difference(plain.elastic, [&](int i) { return sweep.elasticForce(i); }), 1e-12);
            EXPECT_LT(difference(plain.crease, [&](int i) { return sweep.channelForce(creaseChannel, i); }), 1e-7);
            EXPECT_TRUE(std::isfinite(sweep.elementEnergies().elastic));
            EXPECT_TRUE(std::isfinite(sweep.elementEnergies().kink));
            for (int step = 0; step < 3; ++step) EXPECT_TRUE(sweep.step(moving(Sums::energies)));
            EXPECT_TRUE(std::isfinite(sweep.motionSums().kinetic));
        }
    }
}

TEST(Sweep, NumbersThatAreNotFiniteAreReported) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    for (Sums sums : allSums)
        for (double bad : {nan, inf, -inf})
            for (int parts : partCounts)
                for (int node : {0, 77, 167}) {
                    const Model m = Model(13, 11, 0.01, false).withAll();
                    Sweep sweep = m.sweep(parts, 64);
                    ASSERT_TRUE(sweep.step(moving(sums)));
                    sweep.x.y[node] = bad;
                    EXPECT_FALSE(sweep.step(moving(sums))) << "position " << bad;
                    sweep = m.sweep(parts, 64);
                    sweep.v.z[node] = bad;
                    EXPECT_FALSE(sweep.step(moving(sums))) << "velocity " << bad;
                    sweep = m.sweep(parts, 64);
                    sweep.outside = {{node, Vector3d(0., bad, 0.)}};
                    EXPECT_FALSE(sweep.step(moving(sums))) << "force " << bad;
                }
}

TEST(Sweep, LostNodeOfOthersIsSeenInItsNeighbours) {
    Model m(13, 11, 0.01, false);
    m.owned[50] = false;
    Sweep sweep = m.sweep(2, 64);
    sweep.x.x[50] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(sweep.step(moving()));
}

} // namespace
