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

/// The three arrays of some Coordinates, or none.
struct Components {
    double *x = nullptr, *y = nullptr, *z = nullptr;

    Components() = default;
    explicit Components(Coordinates& c) : x(c.x.data()), y(c.y.data()), z(c.z.data()) {}
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

/// Where forces are added: on all nodes, on those from `first` on, or nowhere.
struct Window {
    Components values; ///< of the node `first` and those that follow
    long first = 0;

    Window() = default;
    explicit Window(Coordinates& c, long firstNode = 0) : values(c), first(firstNode) {}
    bool isThere() const { return values.x; }
    Components from(long node) const { return values + (node - first); }
    void add(long node, const Eigen::Vector3d& v) const { values.add(node - first, v); }
};

} // namespace membrane
