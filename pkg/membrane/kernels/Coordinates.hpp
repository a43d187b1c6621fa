// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "Array.hpp"
#include <Eigen/Core>
#include <algorithm>
#include <vector>

namespace membrane {

/// One vector for each node, each component in an array of its own, so that loops over nodes are vectorised.
struct Coordinates {
    Array x, y, z;

    std::size_t size() const { return x.size(); }
    void assign(std::size_t count) {
        for (auto* component : {&x, &y, &z}) component->assign(count, 0.);
    }
    Eigen::Vector3d at(std::size_t i) const { return {x[i], y[i], z[i]}; }
    void set(std::size_t i, const Eigen::Vector3d& v) {
        x[i] = v[0];
        y[i] = v[1];
        z[i] = v[2];
    }
    void add(std::size_t i, const Eigen::Vector3d& v) {
        x[i] += v[0];
        y[i] += v[1];
        z[i] += v[2];
    }
    std::vector<Eigen::Vector3d> points() const {
        std::vector<Eigen::Vector3d> all(size());
        for (std::size_t i = 0; i < size(); ++i) all[i] = at(i);
        return all;
    }
};

/// The three arrays of some Coordinates, or none. `first` is the node of index 0 in a window of all nodes.
struct Components {
    double *x = nullptr, *y = nullptr, *z = nullptr;

    Components() = default;
    explicit Components(Coordinates& c, long first = 0)
        : x(c.x.data() - first), y(c.y.data() - first), z(c.z.data() - first) {}
    Components operator+(long offset) const {
        Components moved;
        moved.x = x + offset;
        moved.y = y + offset;
        moved.z = z + offset;
        return moved;
    }
    Eigen::Vector3d at(long i) const { return {x[i], y[i], z[i]}; }
    void set(long i, const Eigen::Vector3d& v) const {
        x[i] = v[0];
        y[i] = v[1];
        z[i] = v[2];
    }
    void add(long i, const Eigen::Vector3d& v) const {
        x[i] += v[0];
        y[i] += v[1];
        z[i] += v[2];
    }
};

} // namespace membrane
