// SPDX-License-Identifier: GPL-2.0-or-later
// Products with the stiffness and damping of a membrane against the matrices written out.
#include <gtest/gtest.h>

#include "dense_forces.hpp"

using namespace membrane;

namespace {

/// k K + c C by its products with the unit vectors.
Eigen::MatrixXd columns(const LinearForces& forces, double k, double c) {
    const std::size_t n = forces.inverseRoot.size();
    Eigen::MatrixXd matrix(3 * n, 3 * n);
    for (std::size_t column = 0; column < 3 * n; ++column) {
        NodeVectors x(n, Eigen::Vector4d::Zero()), y = x;
        x[column / 3][column % 3] = 1.;
        addProduct(forces, k, c, x, y);
        for (std::size_t i = 0; i < n; ++i) {
            EXPECT_EQ(y[i][3], 0.);
            matrix.block<3, 1>(3 * i, column) = y[i].head<3>();
        }
    }
    return matrix;
}

TEST(LinearForces, ProductsAreThoseOfTheMatrices) {
    dense::forSheets([](const dense::Sheet& sheet) {
        const LinearForces forces = sheet.forces();
        const Eigen::MatrixXd k = dense::stiffness(forces), c = dense::damping(forces);
        EXPECT_LT((columns(forces, 1., 0.) - k).norm(), 1e-13 * k.norm());
        EXPECT_LE((columns(forces, 0., 1.) - c).norm(), 1e-13 * c.norm());
        EXPECT_LT((columns(forces, 2., 3.) - 2. * k - 3. * c).norm(), 1e-13 * (k.norm() + c.norm()));
    });
}

TEST(LinearForces, ProductsAreAdded) {
    const dense::Sheet sheet(1, 1e-3, 10., 1.);
    const LinearForces forces = sheet.forces();
    const NodeVectors x(sheet.masses.size(), {1., -2., 3., 0.});
    NodeVectors once(x.size(), Eigen::Vector4d::Zero()), twice = once;
    addProduct(forces, 1., 1., x, once);
    for (int k = 0; k < 2; ++k) addProduct(forces, 1., 1., x, twice);
    double difference = 0., size = 0.;
    for (std::size_t i = 0; i < x.size(); ++i) {
        difference += (twice[i] - 2. * once[i]).norm();
        size += once[i].norm();
    }
    EXPECT_GT(size, 0.);
    EXPECT_LT(difference, 1e-6 * size); // forces of a rigid displacement cancel but for drag
}

TEST(LinearForces, AreDampedIfAnythingIs) {
    dense::Sheet sheet(3, 0., 10., 0.); // of springs
    EXPECT_TRUE(sheet.forces().damped);
    sheet.drag.clear();
    EXPECT_TRUE(sheet.forces().damped);
    sheet.damping.assign(sheet.damping.size(), 0.);
    EXPECT_FALSE(sheet.forces().damped);
    sheet.drag.assign(sheet.masses.size(), 0.);
    sheet.drag.back() = 1e-9;
    EXPECT_TRUE(sheet.forces().damped);
    sheet = dense::Sheet(2, 0., 0., 0.); // of plane stress
    EXPECT_FALSE(sheet.forces().damped);
    sheet.film.time = 1e-9;
    EXPECT_TRUE(sheet.forces().damped);
}

} // namespace
