// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "ElementForce.hpp"
#include "LeapfrogKernel.hpp"
#include <string>

namespace membrane {

/// What one step of a Sweep is given besides its state.
struct SweepStep {
    double dt = 0.;                                    ///< [s]
    Eigen::Vector3d gravity = Eigen::Vector3d::Zero(); ///< [m/s²]
    double localDamping = 0.;                          ///< YADE's damping of NewtonIntegrator [-]
    double centrifugal = 0.;                           ///< see Motion
    bool move = true;                                  ///< false: forces only
    bool elastic = true;                               ///< false: without the forces of strain energy
    bool apart = false;                                ///< keep the forces of each channel apart; needed for `sums`
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

    /// \param forces first those with most blocks, that of the sides;  \param parts threads to use, >= 1
    /// \param chunkSize nodes that are moved together
    /// \throws std::invalid_argument where there are too many channels, or two of drag
    void prepare(const ElementForces& forces, const std::vector<double>& masses, const std::vector<char>& owned,
                 int parts, int chunkSize = defaultChunk);

    /// Lets go of the forces, and of what they point to; the state and the last step's forces stay.
    void dropForces() { forces_.clear(); }

    /// \return whether all nodes are still in finite places
    bool step(const SweepStep& now);

    /// Forces [N] of the last step on a node that is not owned; on any node if the step did not move. If the step kept
    /// them not apart, those of all channels but drag's are in elasticForce().
    Eigen::Vector3d force(int node) const;
    Eigen::Vector3d elasticForce(int node) const { return elastic_.at(node); }
    Eigen::Vector3d channelForce(int channel, int node) const;
    /// Names of the channels, those of Channel first; what their work is; their forces.
    const std::vector<std::string>& channels() const { return channels_; }
    Exchange exchange(int channel) const { return exchange_[channel]; }
    const ElementForces& forces() const { return forces_; }
    /// A force of a channel; null: none.
    const ElementForce* forceOf(int channel) const;
    /// Forces [N] from outside on owned nodes, for the next step only.
    std::vector<std::pair<int, Eigen::Vector3d>> outside;

    /// Sums over the owned nodes, and energies of all elements, in the last step with such.
    const MotionSums& motionSums() const { return motion_; }
    const GroupEnergy& elementEnergies() const { return energy_; }
    /// What the kinks of the next step are counted from; empty if there is nothing of the last step.
    std::vector<double> memory() const;
    std::size_t memorySize() const;
    void setMemory(const std::vector<double>& memory);
    bool remembers() const { return remembers_; }

    int parts() const { return partition_.partCount(); }
    static constexpr int defaultChunk = 512;

private:
    ElementForces forces_;
    std::vector<int> channelOf_; ///< of each force
    std::vector<std::string> channels_;
    std::vector<Exchange> exchange_;
    double dragFactor_ = 0.;
    Partition partition_;
    Array mass_;
    std::vector<int>
        reach_; ///< of each chunk: end of the nodes that its elements and those before it touch; empty: small mesh
    std::vector<int> foreign_; ///< nodes that are not owned, ascending
    Coordinates elastic_;
    std::vector<Coordinates> own_; ///< of each channel; empty: never kept apart yet, or that of drag
    Array dragWeight_;
    bool remembers_ = false;
    bool moved_ = true; ///< whether the last step did

    /// Forces of a part's elements that reach into another part: on nodes first..last-1.
    struct Border {
        int first = 0, last = 0;
        Coordinates elastic;
        std::vector<Coordinates> own;
        Array dragWeight;
    };
    std::vector<Border> borders_;
    struct PartSums {
        MotionSums motion;
        GroupEnergy energy;
        double lost = 0.;
    };
    std::vector<PartSums> partSums_;
    MotionSums motion_;
    GroupEnergy energy_;

    void clearForces();
    void clearForces(int node);
    struct Targets {
        Window elastic;
        Window own[maxChannels];
        WeightWindow dragWeight;

        void choose(Coordinates& all, std::vector<Coordinates>& each, bool apart, int first);
    };
    void nameChannels();
    void recall(double dt);
    GroupEnergy addGroup(int group, const Targets& to, const SweepStep& now, Prefetch* prefetch);
    void prefetchAfter(int chunk, int part, Prefetch& prefetch);
    void computeBorder(int part, const SweepStep& now);
    void addBorders(int part, bool apart);
    void sweepPart(int part, const SweepStep& now);
    void makeBorders();
    void keepApart();
    void makeReach();
};

} // namespace membrane
