// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "pkg/membrane/kernels/CreaseKernel.hpp"
#include "pkg/membrane/kernels/FilmKernel.hpp"
#include "pkg/membrane/kernels/SideKernel.hpp"
#include "shapes.hpp"
#include <Eigen/Eigenvalues>

/// The matrices of LinearForces written out, and membranes for the tests of what is made of them.
namespace dense {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using membrane::LinearForces;
using shapes::Vector3d;

/// += factor (sum of vector_i x_i)² for displacements x_i of some nodes
inline void addSquare(MatrixXd& to, double factor, const std::vector<std::pair<int, Vector3d>>& corners) {
    VectorXd row = VectorXd::Zero(to.rows());
    for (const auto& [node, vector] : corners) row.segment<3>(3 * node) += vector;
    to += factor * row * row.transpose();
}

inline MatrixXd stiffness(const LinearForces& forces) {
    const std::size_t size = 3 * forces.inverseRoot.size();
    MatrixXd k = MatrixXd::Zero(size, size);
    for (const auto& s : forces.sides) {
        addSquare(k, s.axial - s.lateral, {{s.a, -s.direction}, {s.b, s.direction}});
        for (int axis = 0; axis < 3; ++axis)
            addSquare(k, s.lateral, {{s.a, -Vector3d::Unit(axis)}, {s.b, Vector3d::Unit(axis)}});
    }
    for (const auto& t : forces.triangles) {
        for (const auto& g : t.gradient) addSquare(k, 1., {{t.node[0], g[0]}, {t.node[1], g[1]}, {t.node[2], g[2]}});
        for (int i = 0; i < 3; ++i)
            for (int axis = 0; axis < 3; ++axis)
                addSquare(k, t.lateral[i],
                          {{t.node[(i + 1) % 3], -Vector3d::Unit(axis)}, {t.node[(i + 2) % 3], Vector3d::Unit(axis)}});
    }
    for (const auto& c : forces.creases) {
        const auto corners = [&c](const Vector3d& ofC, const Vector3d& ofD) {
            return std::vector<std::pair<int, Vector3d>>{{c.a, -(1. - c.footC) * ofC - (1. - c.footD) * ofD},
                                                         {c.b, -c.footC * ofC - c.footD * ofD},
                                                         {c.c, ofC},
                                                         {c.d, ofD}};
        };
        addSquare(k, c.moment, corners(c.gradC, c.gradD));
        for (int axis = 0; axis < 3; ++axis) {
            addSquare(k, c.turningC, corners(Vector3d::Unit(axis), Vector3d::Zero()));
            addSquare(k, c.turningD, corners(Vector3d::Zero(), Vector3d::Unit(axis)));
        }
    }
    return k;
}

inline MatrixXd damping(const LinearForces& forces) {
    const std::size_t size = 3 * forces.inverseRoot.size();
    MatrixXd c = MatrixXd::Zero(size, size);
    for (const auto& s : forces.sides) addSquare(c, s.damping, {{s.a, -s.direction}, {s.b, s.direction}});
    for (const auto& t : forces.triangles)
        for (const auto& g : t.gradient)
            addSquare(c, t.time, {{t.node[0], g[0]}, {t.node[1], g[1]}, {t.node[2], g[2]}});
    for (std::size_t i = 0; i < forces.drag.size(); ++i) c.diagonal().segment<3>(3 * i).array() += forces.drag[i];
    return c;
}

/// The step at which the largest eigenvalue of (dt² K + 4 dt C)/M is 4.
inline double criticalStep(const LinearForces& forces) {
    VectorXd scale(3 * forces.inverseRoot.size());
    for (std::size_t i = 0; i < forces.inverseRoot.size(); ++i)
        scale.segment<3>(3 * i).setConstant(forces.inverseRoot[i]);
    const MatrixXd k = scale.asDiagonal() * stiffness(forces) * scale.asDiagonal();
    const MatrixXd c = scale.asDiagonal() * damping(forces) * scale.asDiagonal();
    double step = 1., change = 1.;
    // Newton's method: at the vector of the largest eigenvalue the condition is a quadratic equation for the step.
    while (std::abs(change) > 1e-10) {
        const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(step * k + 4. * c);
        const VectorXd v = solver.eigenvectors().rightCols<1>();
        const double stiff = v.dot(k * v), damped = v.dot(c * v);
        const double next = 2. / (std::sqrt(damped * damped + stiff) + damped);
        change = next / step - 1.;
        step = next;
    }
    return step;
}

/// Of something with a rest state, positions and masses of its nodes, coefficients of damping and drag, a crease law.
template <class Model> LinearForces linearForces(const Model& m) {
    LinearForces all(m.masses);
    membrane::SideForces(m.rest, m.damping).addTo(all, m.positions, m.positions);
    if (m.crease.bending > 0.) membrane::CreaseForce(m.rest, m.crease).addTo(all, m.positions, m.positions);
    for (std::size_t i = 0; i < m.drag.size(); ++i) all.addDrag(static_cast<int>(i), m.drag[i]);
    return all;
}

/// A sheet with all that bears on the time step.
struct Sheet {
    membrane::RestState rest;
    membrane::Points positions;
    std::vector<double> masses, damping, drag;
    membrane::CreaseLaw crease;
    membrane::MeshInput in;
    membrane::FilmLaw film; ///< of every other sheet

    /// \param crumple how far nodes are from the plane [m];  \param rate of the sides' damping and of drag [1/s]
    Sheet(unsigned seed, double crumple, double rate, double bending) {
        shapes::Random random(seed);
        in = shapes::sheet(4, 3, 0.01, seed, true);
        in.allowNegativeStiffness = true;
        in.pointMasses.assign(in.nodes.size(), 0.);
        in.pointMasses[7] = 0.1; // beside 1e-3 kg
        in.planeStress = seed % 2 == 0;
        if (in.planeStress) {
            film.young = in.young, film.poisson = in.poisson, film.thickness = in.thickness;
            film.time = rate * 1e-9;
        }
        rest = restState(in);
        positions = in.nodes;
        masses = rest.masses;
        for (Vector3d& x : positions) x = 1.01 * x + random.vector(crumple);
        if (rate > 0.) {
            for (const auto& s : rest.sides)
                damping.push_back(rate * random.between(0., 1.) * (masses[s.a] + masses[s.b]));
            for (const double mass : masses) drag.push_back(rate * random.between(0., 1.) * mass);
        }
        crease = {bending, 10., 0.3, true};
        masses[0] = masses[11] = 0.; // held
    }

    LinearForces forces() const {
        LinearForces all = linearForces(*this);
        if (in.planeStress) membrane::FilmForce(in.nodes, in.triangles, film).addTo(all, positions, positions);
        return all;
    }
};

/// Calls a test with sheets in which stiffness, damping or creases decide the step.
template <class Test> void forSheets(const Test& test) {
    unsigned seed = 100;
    for (const double crumple : {0., 1e-3, 0.02})
        for (const double rate : {0., 1e2, 1e4, 1e6})
            for (const double bending : {0., 1e3, 1e6}) {
                SCOPED_TRACE(testing::Message() << "crumple " << crumple << " rate " << rate << " bending " << bending);
                test(Sheet(++seed, crumple, rate, bending));
            }
}

} // namespace dense
