// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "CreaseKernel.hpp"
#include "DragKernel.hpp"
#include "LeapfrogKernel.hpp"
#include "SideKernel.hpp"

namespace membrane {

/// Which forces act, besides those of the sides.
struct Laws {
    std::vector<double> damping; ///< c of each side [N s/m]; empty: none
    CreaseLaw crease;            ///< bending = 0: none
    double airDensity = 0.;      ///< [kg/m³]; 0: none
};

/// What one step of a Sweep is given besides its state.
struct SweepStep {
    double dt = 0.;                                    ///< [s]
    Eigen::Vector3d gravity = Eigen::Vector3d::Zero(); ///< [m/s²]
    double localDamping = 0.;                          ///< YADE's damping of NewtonIntegrator [-]
    double centrifugal = 0.;                           ///< see Motion
    bool move = true;                                  ///< false: forces only
    bool elastic = true;                               ///< false: without the sides' springs
    bool apart = false; ///< keep the forces of damping and creases apart from those of the springs; needed for `sums`
    Sums sums = Sums::none;
};

/// All forces of a membrane and the leapfrog of its nodes, in one sweep through memory: as soon as the last force on a
/// node is known, and before the node leaves the cache, it is moved. Nodes that are not its own (`owned`) are left
/// where they are, with the forces on them in `force()`.
///
/// With several parts (threads), elements between nodes of two parts are computed first, while all nodes are still in
/// their places, into a window of forces of their own. Sums of forces depend on the number of parts, but never on
/// chance.
class Sweep {
public:
    Coordinates x, v; ///< positions [m]; velocities [m/s], half a step before
    Coordinates u;    ///< velocities [m/s] at the time of the positions, of which damping and drag are functions

    /// \param parts threads to use, >= 1;  \param chunkSize nodes that are moved together
    void prepare(const RestState& rest, const std::vector<Eigen::Vector3i>& triangles, const Laws& laws,
                 const std::vector<double>& masses, const std::vector<char>& owned, int parts,
                 int chunkSize = defaultChunk);

    /// \return whether all nodes are still in finite places
    bool step(const SweepStep& now);

    /// Forces [N] of the last step on a node that is not owned; on any node if the step did not move. If the step kept
    /// them not apart, those of creases and damping are in elasticForce().
    Eigen::Vector3d force(int node) const;
    Eigen::Vector3d elasticForce(int node) const { return elastic_.at(node); }
    Eigen::Vector3d creaseForce(int node) const { return crease_.size() ? crease_.at(node) : Eigen::Vector3d::Zero(); }
    Eigen::Vector3d dampingForce(int node) const {
        return damping_.size() ? damping_.at(node) : Eigen::Vector3d::Zero();
    }
    Eigen::Vector3d dragForce(int node) const;
    /// Forces [N] from outside on owned nodes, for the next step only.
    std::vector<std::pair<int, Eigen::Vector3d>> outside;

    /// Sums over the owned nodes, and energies of all sides, in the last step with such.
    const MotionSums& motionSums() const { return motion_; }
    const SideEnergy& sideEnergies() const { return energy_; }
    /// Lengths [m] of the sides in the last step with sums; empty if there was none.
    std::vector<double> lengths() const;
    /// Gives those lengths: the kinks of the next step are counted from them.
    void setLengths(const std::vector<double>& lengths);
    bool hasLengths() const { return hasLengths_; }

    int parts() const { return partition_.partCount(); }
    static constexpr int defaultChunk = 512;

private:
    const RestState* rest_ = nullptr;
    Laws laws_;
    Partition partition_;
    SideTable sides_;
    CreaseTable creases_;
    DragTable drag_;
    Array mass_;
    std::vector<int>
        reach_; ///< of each chunk: end of the nodes that its elements and those before it touch; empty: small mesh
    std::vector<int> foreign_; ///< nodes that are not owned, ascending
    Coordinates elastic_, damping_, crease_;
    Array dragWeight_;
    std::size_t sideCount_ = 0;
    bool hasLengths_ = false;
    bool moved_ = true; ///< whether the last step did

    /// Forces of a part's elements that reach into another part: on nodes first..last-1.
    struct Border {
        int first = 0, last = 0;
        Coordinates elastic, damping, crease;
        Array dragWeight;
    };
    std::vector<Border> borders_;
    struct PartSums {
        MotionSums motion;
        SideEnergy energy;
        double lost = 0.;
    };
    std::vector<PartSums> partSums_;
    MotionSums motion_;
    SideEnergy energy_;

    void clearForces();
    void clearForces(int node);
    struct Targets {
        Window elastic, damping, crease;
        WeightWindow dragWeight;
    };
    SideEnergy addGroup(int group, const Targets& to, const SweepStep& now, Prefetch* prefetch);
    void prefetchAfter(int chunk, int part, Prefetch& prefetch);
    void computeBorder(int part, const SweepStep& now);
    void addBorders(int part, bool apart);
    void sweepPart(int part, const SweepStep& now);
    void makeBorders();
    void keepApart();
    void makeReach();
};

} // namespace membrane
