// SPDX-License-Identifier: GPL-2.0-or-later
// From a mesh to sides, creases and masses, and what is refused.
#include "pkg/membrane/mechanics/RestState.hpp"
#include "pkg/membrane/mechanics/TriangleStiffness.hpp"
#include "shapes.hpp"
#include <algorithm>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <string>

using namespace membrane;
using shapes::Vector3d;

namespace {

/// A unit square cut along its diagonal (0, 2), of two right isosceles triangles, with a tether from node 1 to node 4.
MeshInput square() {
    MeshInput in;
    in.nodes = {{0., 0., 0.}, {1., 0., 0.}, {1., 1., 0.}, {0., 1., 0.}, {3., 0., 0.}};
    in.triangles = {{0, 1, 2}, {0, 2, 3}};
    in.creases = {{2, 0}};
    in.creaseSigns = {1};
    in.cables = {{4, 1}};
    in.young = 2e9, in.poisson = 0.34, in.density = 1400., in.thickness = 1e-3;
    in.cableStiffness = 200., in.cableDensity = 0.01;
    in.alpha = 100., in.alphaCrease = 1000.;
    return in;
}

const Side& sideOf(const RestState& rest, int a, int b) {
    for (const Side& side : rest.sides)
        if (side.a == a && side.b == b) return side;
    throw std::logic_error("no side (" + std::to_string(a) + ", " + std::to_string(b) + ")");
}

TEST(RestState, SharedSideHasTheSumOfItsTrianglesStiffnesses) {
    const RestState rest = restState(square());
    ASSERT_EQ(rest.sides.size(), 6u);
    const double film = 2e9 * 1e-3;
    EXPECT_NEAR(sideOf(rest, 0, 2).stiffness / film, 2. * 0.2056, 2e-4);
    for (const auto& [a, b] : {std::pair(0, 1), std::pair(1, 2), std::pair(2, 3), std::pair(0, 3)})
        EXPECT_NEAR(sideOf(rest, a, b).stiffness / film, 0.4081, 1e-4);
}

TEST(RestState, SidesAreOrderedWithTheFilmFirstAndCablesLast) {
    const RestState rest = restState(square());
    for (const Side& side : rest.sides) EXPECT_LT(side.a, side.b);
    EXPECT_EQ(rest.sides.back().kind, SideKind::cable);
    EXPECT_EQ(sideOf(rest, 0, 2).kind, SideKind::crease);
    EXPECT_EQ(sideOf(rest, 0, 1).kind, SideKind::film);
    EXPECT_DOUBLE_EQ(sideOf(rest, 0, 2).restLength, std::sqrt(2.));
}

/// A disordered sheet with creases, numbered at random, and cables between nodes that are no neighbours.
MeshInput shuffledSheet(unsigned seed) {
    MeshInput in = shapes::sheet(6, 5, 0.01, seed, true);
    const int n = static_cast<int>(in.nodes.size());
    std::vector<int> number(n);
    std::iota(number.begin(), number.end(), 0);
    std::mt19937 random(seed);
    std::shuffle(number.begin(), number.end(), random);
    const Points nodes = in.nodes;
    for (int i = 0; i < n; ++i) in.nodes[number[i]] = nodes[i];
    for (auto& triangle : in.triangles)
        for (int& node : triangle) node = number[node];
    for (auto& crease : in.creases)
        for (int& node : crease) node = number[node];
    for (int i : {30, 3, 17, 8}) in.cables.emplace_back(number[i], number[(i + 15) % n]);
    in.cableStiffness = 200.;
    std::shuffle(in.triangles.begin(), in.triangles.end(), random);
    return in;
}

TEST(RestState, StiffnessesOfAnyNumberingAreSummedInTheOrderOfTheTriangles) {
    const MeshInput in = shuffledSheet(17);
    const RestState rest = restState(in);
    std::map<std::pair<int, int>, double> expected; // to the last bit
    for (const auto& t : in.triangles) {
        Vector3d lengths;
        for (int i = 0; i < 3; ++i) lengths[i] = (in.nodes[t[(i + 1) % 3]] - in.nodes[t[(i + 2) % 3]]).norm();
        const double area = triangleArea(in.nodes[t[0]], in.nodes[t[1]], in.nodes[t[2]]);
        const Vector3d k = triangleStiffness(lengths, area, in.young, in.poisson, in.thickness);
        for (int i = 0; i < 3; ++i) expected[std::minmax({t[(i + 1) % 3], t[(i + 2) % 3]})] += k[i];
    }
    ASSERT_EQ(rest.filmSides, expected.size());
    ASSERT_EQ(rest.sides.size(), expected.size() + in.cables.size());
    auto side = rest.sides.begin();
    for (const auto& [nodes, stiffness] : expected) { // sorted by nodes
        EXPECT_EQ(std::pair(side->a, side->b), nodes);
        EXPECT_EQ(side->stiffness, stiffness);
        ++side;
    }
    for (const auto& cable : in.cables) {
        EXPECT_EQ(side->kind, SideKind::cable);
        EXPECT_EQ(std::pair(side->a, side->b), std::pair(cable.minCoeff(), cable.maxCoeff()));
        ++side;
    }
}

TEST(RestState, SideIsFoundBetweenItsNodesAndNoneBetweenOthers) {
    const RestState rest = restState(shuffledSheet(18));
    const int n = static_cast<int>(rest.masses.size());
    std::map<std::pair<int, int>, int> sides;
    for (std::size_t i = 0; i < rest.sides.size(); ++i) sides[{rest.sides[i].a, rest.sides[i].b}] = static_cast<int>(i);
    for (int a = -1; a <= n; ++a) {
        for (int b = -1; b <= n; ++b) {
            const auto side = sides.find(std::minmax(a, b));
            EXPECT_EQ(rest.sideBetween(a, b), side == sides.end() ? -1 : side->second) << a << " " << b;
        }
    }
}

TEST(RestState, BucklingParameterIsThatOfTheKindOfSide) {
    const RestState rest = restState(square());
    const double unit = shapes::pi * shapes::pi * 1e-6 / 12.; // pi² h² / 12
    EXPECT_NEAR(sideOf(rest, 0, 1).critical, 1. - 100. * unit, 1e-12);
    EXPECT_NEAR(sideOf(rest, 0, 2).critical, std::sqrt(2.) - 1000. * unit / std::sqrt(2.), 1e-12);
    EXPECT_EQ(sideOf(rest, 1, 4).critical, sideOf(rest, 1, 4).restLength);
}

TEST(RestState, CableHasStiffnessEAOverLengthAndHalfItsMassAtEachEnd) {
    const RestState rest = restState(square());
    EXPECT_DOUBLE_EQ(sideOf(rest, 1, 4).stiffness, 100.);
    EXPECT_DOUBLE_EQ(rest.masses[4], 0.01);
}

TEST(RestState, MassesAreThirdsOfTheTrianglesPlusCablesPlusPointMasses) {
    MeshInput in = square();
    in.pointMasses = {0., 0., 0., 0.7, 0.2};
    const RestState rest = restState(in);
    const double third = 1400. * 1e-3 * 0.5 / 3.;
    const double expected[] = {2. * third, third + 0.01, 2. * third, third + 0.7, 0.01 + 0.2};
    for (int i = 0; i < 5; ++i) EXPECT_NEAR(rest.masses[i], expected[i], 1e-14) << "node " << i;
    EXPECT_NEAR(rest.area, 1., 1e-15);
}

TEST(RestState, MassOfADisorderedSheetIsThatOfItsArea) {
    const MeshInput in = shapes::sheet(6, 5, 0.01, 13, true);
    const RestState rest = restState(in);
    double mass = 0., area = 0.;
    for (double m : rest.masses) mass += m;
    for (const auto& t : in.triangles) area += triangleArea(in.nodes[t[0]], in.nodes[t[1]], in.nodes[t[2]]);
    EXPECT_NEAR(rest.area / area, 1., 1e-14);
    EXPECT_NEAR(mass / (in.density * in.thickness * area), 1., 1e-13);
}

TEST(RestState, CreaseKnowsItsApicesAndRestLengths) {
    const RestState rest = restState(square());
    ASSERT_EQ(rest.creases.size(), 1u);
    const Crease& c = rest.creases[0];
    // Triangle (0, 2, 3) runs from 0 to 2, so its apex is C.
    EXPECT_EQ(c.a, 0);
    EXPECT_EQ(c.b, 2);
    EXPECT_EQ(c.c, 3);
    EXPECT_EQ(c.d, 1);
    EXPECT_NEAR(c.rest.length, std::sqrt(2.), 1e-15);
    EXPECT_NEAR(c.rest.heightC, std::sqrt(0.5), 1e-15);
    EXPECT_NEAR(c.rest.heightD, std::sqrt(0.5), 1e-15);
}

TEST(RestState, MountainSticksOutTowardsTheNormalsAndValleyAwayFromThem) {
    // Both apices lowered under a mountain fold, or raised over a valley fold, open by less than pi.
    for (int sign : {1, -1}) {
        for (bool reversed : {false, true}) { // the crease's own direction must not count
            MeshInput in = square();
            in.creaseSigns = {sign};
            if (reversed) in.creases = {{0, 2}};
            const Crease c = restState(in).creases[0];
            Points x = in.nodes;
            EXPECT_NEAR(creaseState(c.rest, x[c.a], x[c.b], x[c.c], x[c.d]).theta, shapes::pi, 1e-14);
            x[1].z() = x[3].z() = -sign * std::sqrt(0.5);
            EXPECT_NEAR(creaseState(c.rest, x[c.a], x[c.b], x[c.c], x[c.d]).theta, 0.5 * shapes::pi, 1e-14);
        }
    }
}

TEST(RestState, DoesNotDependOnWhereAndHowTheMeshLies) {
    shapes::Random random(14);
    MeshInput in = shapes::sheet(4, 3, 0.01, 15, true);
    const RestState rest = restState(in);
    in.nodes = shapes::placed(in.nodes, 1., random.rotation(), random.vector());
    const RestState turned = restState(in);
    ASSERT_EQ(turned.sides.size(), rest.sides.size());
    for (std::size_t i = 0; i < rest.sides.size(); ++i) {
        EXPECT_NEAR(turned.sides[i].restLength / rest.sides[i].restLength, 1., 1e-13);
        EXPECT_NEAR(turned.sides[i].stiffness / rest.sides[i].stiffness, 1., 1e-11);
    }
    for (std::size_t i = 0; i < rest.creases.size(); ++i) {
        EXPECT_NEAR(turned.creases[i].rest.heightC / rest.creases[i].rest.heightC, 1., 1e-13);
        EXPECT_EQ(turned.creases[i].rest.sign, rest.creases[i].rest.sign);
    }
}

TEST(RestState, ScalesWithTheMesh) {
    const MeshInput in = shapes::sheet(4, 3, 0.01, 16, true);
    const RestState rest = restState(in);
    for (double scale : shapes::scales) {
        MeshInput large = in;
        for (Vector3d& node : large.nodes) node *= scale;
        large.thickness *= scale;
        const RestState scaled = restState(large);
        for (std::size_t i = 0; i < rest.sides.size(); ++i) {
            EXPECT_NEAR(scaled.sides[i].stiffness / (scale * rest.sides[i].stiffness), 1., 1e-11);
            EXPECT_NEAR(scaled.sides[i].critical / (scale * rest.sides[i].critical), 1., 1e-13);
        }
        for (std::size_t i = 0; i < rest.masses.size(); ++i)
            EXPECT_NEAR(scaled.masses[i] / (scale * scale * scale * rest.masses[i]), 1., 1e-12);
    }
}

TEST(RestState, NegativeStiffnessIsAcceptedOnDemandOnly) {
    MeshInput in = square();
    in.nodes[1] = {0.6, 0.4, 0.}; // a tenth of the diagonal's length away from it
    EXPECT_THROW(restState(in), std::invalid_argument);
    in.allowNegativeStiffness = true;
    const RestState rest = restState(in);
    EXPECT_NEAR(sideOf(rest, 0, 1).stiffness / 2e6, 0.7928, 1e-4);
    EXPECT_NEAR(sideOf(rest, 0, 2).stiffness / 2e6, -0.3209 + 0.2056, 2e-4);
}

// ---------------------------------------------------------------------------------------------------------------------
// What is refused

struct Refusal {
    const char* name;
    std::function<void(MeshInput&)> spoil;
    std::vector<std::string> said; ///< parts of the message
};

class RefusedMesh : public testing::TestWithParam<Refusal> {};

TEST_P(RefusedMesh, IsNamedWithFieldAndValue) {
    MeshInput in = square();
    ASSERT_NO_THROW(restState(in));
    GetParam().spoil(in);
    try {
        restState(in);
        FAIL() << "was accepted";
    } catch (const std::invalid_argument& error) {
        for (const std::string& part : GetParam().said)
            EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
}

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();

const Refusal refusals[] = {
    {"YoungZero", [](MeshInput& in) { in.young = 0.; }, {"young = 0", "> 0"}},
    {"YoungNan", [](MeshInput& in) { in.young = nan; }, {"young = nan"}},
    {"ThicknessInfinite", [](MeshInput& in) { in.thickness = infinity; }, {"thickness = inf", "finite"}},
    {"DensityNegative", [](MeshInput& in) { in.density = -1.; }, {"density = -1"}},
    {"PoissonAboveHalf", [](MeshInput& in) { in.poisson = 0.6; }, {"poisson = 0.6", "(-1, 0.5]"}},
    {"PoissonMinusOne", [](MeshInput& in) { in.poisson = -1.; }, {"poisson = -1"}},
    {"AlphaNegative", [](MeshInput& in) { in.alpha = -5.; }, {"alpha = -5", ">= 0"}},
    {"AlphaCreaseNan", [](MeshInput& in) { in.alphaCrease = nan; }, {"alphaCrease = nan"}},
    {"CableStiffnessZero", [](MeshInput& in) { in.cableStiffness = 0.; }, {"cableStiffness = 0"}},
    {"CableDensityNegative", [](MeshInput& in) { in.cableDensity = -1.; }, {"cableDensity = -1"}},
    {"NodeNan", [](MeshInput& in) { in.nodes[2].y() = nan; }, {"nodes[2]", "finite"}},
    {"NodeAlone", [](MeshInput& in) { in.nodes.emplace_back(9., 9., 9.); }, {"nodes[5]", "mass 0"}},
    {"PointMassesTooFew", [](MeshInput& in) { in.pointMasses = {1.}; }, {"pointMasses has 1", "5 nodes"}},
    {"PointMassNegative",
     [](MeshInput& in) {
         in.pointMasses = {0., 0., -2., 0., 0.};
     },
     {"pointMasses[2] = -2"}},
    {"TriangleOutOfRange", [](MeshInput& in) { in.triangles[1][2] = 5; }, {"triangles[1]", "node 5", "0..4"}},
    {"TriangleNegativeIndex", [](MeshInput& in) { in.triangles[0][0] = -1; }, {"triangles[0]", "node -1"}},
    {"TriangleRepeatsNode", [](MeshInput& in) { in.triangles[0][1] = 0; }, {"triangles[0]", "repeats node 0"}},
    {"TriangleTwice", [](MeshInput& in) { in.triangles.emplace_back(2, 0, 1); }, {"triangles[2]", "repeated"}},
    {"TriangleWithoutArea",
     [](MeshInput& in) {
         in.nodes[1] = {0.5, 0.5, 0.};
     },
     {"triangles[0]", "area"}},
    {"ThirdTriangleOnASide",
     [](MeshInput& in) { in.triangles.emplace_back(0, 2, 4); },
     {"(0, 2)", "triangles[2], besides 0 and 1", "at most 2"}},
    {"CreaseOnNoSide",
     [](MeshInput& in) {
         in.creases[0] = {1, 3};
     },
     {"creases[0]", "not a side"}},
    {"CreaseOnTheEdge",
     [](MeshInput& in) {
         in.creases[0] = {0, 1};
     },
     {"creases[0]", "edge"}},
    {"CreaseTwice",
     [](MeshInput& in) {
         in.creases.emplace_back(0, 2);
         in.creaseSigns.push_back(1);
     },
     {"creases[1]", "repeated"}},
    {"CreaseSignZero", [](MeshInput& in) { in.creaseSigns[0] = 0; }, {"creaseSigns[0] = 0", "+1", "-1"}},
    {"CreaseSignsTooFew", [](MeshInput& in) { in.creaseSigns.clear(); }, {"creaseSigns has 0", "1 creases"}},
    {"TrianglesOrientedUnlike",
     [](MeshInput& in) {
         in.triangles[1] = {2, 0, 3};
     },
     {"creases[0]", "orient"}},
    // Of several faults the first triangle's is named, whatever it is.
    {"RepeatedTriangleBeforeOneOutOfRange",
     [](MeshInput& in) {
         in.triangles.emplace_back(2, 0, 1);
         in.triangles.emplace_back(0, 1, 9);
     },
     {"triangles[2]", "repeated"}},
    {"OneOutOfRangeBeforeARepeatedTriangle",
     [](MeshInput& in) {
         in.triangles.emplace_back(0, 1, 9);
         in.triangles.emplace_back(2, 0, 1);
     },
     {"triangles[2]", "node 9"}},
    {"NoAreaBeforeARepeatedTriangle",
     [](MeshInput& in) {
         in.nodes[1] = {0.5, 0.5, 0.};
         in.triangles.emplace_back(2, 0, 1);
     },
     {"triangles[0]", "area"}},
    {"RepeatedTriangleBeforeAThirdOnASide",
     [](MeshInput& in) {
         in.triangles.emplace_back(3, 2, 0);
         in.triangles.emplace_back(0, 1, 4);
         in.triangles.emplace_back(0, 1, 3);
     },
     {"triangles[2]", "repeated"}},
    {"ThirdOnASideBeforeARepeatedTriangle",
     [](MeshInput& in) {
         in.triangles.emplace_back(0, 2, 4);
         in.triangles.emplace_back(2, 4, 0);
     },
     {"third triangle, triangles[2]"}},
    {"CableTwice", [](MeshInput& in) { in.cables.emplace_back(1, 4); }, {"cables[1]", "doubles"}},
    {"CableOnAFilmSide",
     [](MeshInput& in) {
         in.cables[0] = {0, 1};
     },
     {"cables[0]", "doubles"}},
    {"CableWithoutLength", [](MeshInput& in) { in.nodes[4] = in.nodes[1]; }, {"cables[0]", "length 0"}},
    {"CableOutOfRange",
     [](MeshInput& in) {
         in.cables[0] = {1, 7};
     },
     {"cables[0]", "node 7"}},
};

std::string nameOf(const testing::TestParamInfo<Refusal>& refusal) {
    return refusal.param.name;
}

INSTANTIATE_TEST_SUITE_P(RestState, RefusedMesh, testing::ValuesIn(refusals), nameOf);

} // namespace
