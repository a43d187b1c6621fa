// SPDX-License-Identifier: GPL-2.0-or-later
#include "TimeStepBound.hpp"
#include <cmath>
#include <limits>

namespace membrane {
namespace {

/// A symmetric positive 3 x 3 matrix.
struct Symmetric {
    double xx = 0., yy = 0., zz = 0., xy = 0., yz = 0., zx = 0.;

    /// += factor v v^T
    void addDyad(double factor, const Eigen::Vector3d& v) {
        const Eigen::Vector3d w = factor * v;
        xx += w[0] * v[0];
        yy += w[1] * v[1];
        zz += w[2] * v[2];
        xy += w[0] * v[1];
        yz += w[1] * v[2];
        zx += w[2] * v[0];
    }
    void addUnit(double factor) {
        xx += factor;
        yy += factor;
        zz += factor;
    }
    Symmetric timesItself() const {
        Symmetric s;
        s.xx = xx * xx + xy * xy + zx * zx;
        s.yy = xy * xy + yy * yy + yz * yz;
        s.zz = zx * zx + yz * yz + zz * zz;
        s.xy = xx * xy + xy * yy + zx * yz;
        s.yz = xy * zx + yy * yz + yz * zz;
        s.zx = xx * zx + xy * yz + zx * zz;
        return s;
    }
    /// Its largest eigenvalue or up to 7 % more: the 16th root of the trace of its 16th power.
    double norm() const {
        const double trace = xx + yy + zz;
        if (!(trace > 0.)) return 0.;
        const double f = 1. / trace; // so that no power overflows or vanishes
        Symmetric power{f * xx, f * yy, f * zz, f * xy, f * yz, f * zx};
        for (int doubling = 0; doubling < 4; ++doubling) power = power.timesItself();
        double root = power.xx + power.yy + power.zz;
        for (int halving = 0; halving < 4; ++halving) root = std::sqrt(root);
        return trace * root;
    }
};

/// For each node a number of K and one of C.
struct Rows {
    std::vector<double> k, c;
};

/// The corners of a crease: by how much each moves the apices against their feet, and changes theta.
struct Corners {
    int node[4];
    double weightC[4], weightD[4];
    Eigen::Vector3d gradient[4];

    explicit Corners(const StiffCrease& e)
        : node{e.a, e.b, e.c, e.d}, weightC{-(1. - e.footC), -e.footC, 1., 0.}, weightD{-(1. - e.footD), -e.footD, 0.,
                                                                                        1.} {
        for (int k = 0; k < 4; ++k) gradient[k] = weightC[k] * e.gradC + weightD[k] * e.gradD;
    }
};

/// Norms of the blocks on the diagonal.
Rows ownNorms(const LinearForces& forces) {
    const std::size_t n = forces.inverseRoot.size();
    std::vector<Symmetric> k(n), c(forces.damped ? n : 0);
    for (const TautSide& s : forces.sides) {
        for (const int node : {s.a, s.b}) {
            k[node].addDyad(s.axial - s.lateral, s.direction);
            k[node].addUnit(s.lateral);
            if (forces.damped) c[node].addDyad(s.damping, s.direction);
        }
    }
    for (const StiffTriangle& t : forces.triangles) {
        for (int i = 0; i < 3; ++i) {
            for (const auto& gradient : t.gradient) {
                k[t.node[i]].addDyad(1., gradient[i]);
                if (forces.damped) c[t.node[i]].addDyad(t.time, gradient[i]);
            }
            for (const int node : {t.node[(i + 1) % 3], t.node[(i + 2) % 3]}) k[node].addUnit(t.lateral[i]);
        }
    }
    for (const StiffCrease& e : forces.creases) {
        const Corners corners(e);
        for (int i = 0; i < 4; ++i) {
            const double weightC = corners.weightC[i], weightD = corners.weightD[i];
            k[corners.node[i]].addDyad(e.moment, corners.gradient[i]);
            k[corners.node[i]].addUnit(e.turningC * weightC * weightC + e.turningD * weightD * weightD);
        }
    }
    Rows norms{std::vector<double>(n), std::vector<double>(n)};
    for (std::size_t i = 0; i < n; ++i) {
        norms.k[i] = k[i].norm() + (forces.ground.empty() ? 0. : forces.ground[i]);
        if (forces.damped) norms.c[i] = c[i].norm() + (forces.drag.empty() ? 0. : forces.drag[i]);
    }
    return norms;
}

/// Adds the norms of the blocks beside the diagonal, each times its column's scale.
void addOthers(const LinearForces& forces, const std::vector<double>& scale, Rows& rows) {
    for (const TautSide& s : forces.sides) {
        rows.k[s.a] += s.axial * scale[s.b];
        rows.k[s.b] += s.axial * scale[s.a];
        rows.c[s.a] += s.damping * scale[s.b];
        rows.c[s.b] += s.damping * scale[s.a];
    }
    for (const StiffTriangle& t : forces.triangles) {
        for (int i = 0; i < 3; ++i) { // the block between the ends of side i
            const int begin = (i + 1) % 3, end = (i + 2) % 3, a = t.node[begin], b = t.node[end];
            Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
            for (const auto& gradient : t.gradient) squares += gradient[begin] * gradient[end].transpose();
            const double norm = squares.norm();
            rows.k[a] += (norm + t.lateral[i]) * scale[b];
            rows.k[b] += (norm + t.lateral[i]) * scale[a];
            rows.c[a] += t.time * norm * scale[b];
            rows.c[b] += t.time * norm * scale[a];
        }
    }
    for (const StiffCrease& e : forces.creases) {
        const Corners corners(e);
        double turn[4], moveC[4], moveD[4], allTurn = 0., allC = 0., allD = 0.;
        for (int i = 0; i < 4; ++i) {
            const double u = scale[corners.node[i]];
            allTurn += turn[i] = u * corners.gradient[i].norm();
            allC += moveC[i] = u * std::abs(corners.weightC[i]);
            allD += moveD[i] = u * std::abs(corners.weightD[i]);
        }
        for (int i = 0; i < 4; ++i)
            rows.k[corners.node[i]] += e.moment * corners.gradient[i].norm() * (allTurn - turn[i]) +
                                       e.turningC * std::abs(corners.weightC[i]) * (allC - moveC[i]) +
                                       e.turningD * std::abs(corners.weightD[i]) * (allD - moveD[i]);
    }
}

} // namespace

TimeStepBound timeStepBound(const LinearForces& forces) {
    const std::size_t n = forces.inverseRoot.size();
    const Rows own = ownNorms(forces);
    std::vector<double> scale(n);
    for (std::size_t i = 0; i < n; ++i) scale[i] = forces.inverseRoot[i] > 0. ? 1. : 0.;
    TimeStepBound best{0., 2.};
    // Scales of the second round: the first one's sums, as in power iteration. Heavy nodes then hardly move, and
    // damping beside them counts for less.
    for (int round = 0; round < 2; ++round) {
        Rows rows = own;
        for (std::size_t i = 0; i < n; ++i) {
            rows.k[i] *= scale[i];
            rows.c[i] *= scale[i];
        }
        addOthers(forces, scale, rows);
        TimeStepBound bound{std::numeric_limits<double>::infinity(), 2.};
        for (std::size_t i = 0; i < n; ++i) {
            if (!(scale[i] > 0.)) continue;
            const double inverse = forces.inverseRoot[i] * forces.inverseRoot[i] / scale[i];
            const double k = rows.k[i] *= inverse, c = rows.c[i] *= inverse;
            if (!(k > 0. || c > 0.)) continue;
            const double step = 2. / (std::sqrt(c * c + k) + c); // step² k + 4 step c = 4
            if (step < bound.step) bound = {step, 1. + 0.25 * step * step * k};
        }
        if (bound.step > best.step) best = bound;
        if (!(bound.step < std::numeric_limits<double>::infinity())) break;
        constexpr double least = 1e-3; // a node whose forces are weak must not count as held
        for (std::size_t i = 0; i < n; ++i)
            scale[i] *= least + 0.25 * (bound.step * bound.step * rows.k[i] + 4. * bound.step * rows.c[i]);
    }
    return best;
}

} // namespace membrane
