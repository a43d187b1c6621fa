// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "../mechanics/LinearForces.hpp"
#include "Arrangement.hpp"
#include "Coordinates.hpp"
#include "Prefetch.hpp"
#include "Sums.hpp"
#include <algorithm>
#include <memory>
#include <string>

namespace membrane {

/// What the work of a force is to the energy of a membrane: given back, lost, or brought from outside.
enum class Exchange { stores, loses, brings };

/// Where drag weights are added: on the node `first` and those that follow, or nowhere.
struct WeightWindow {
    double* values = nullptr;
    long first = 0;
};

/// What the elements of one group are computed from and where their forces go.
struct GroupJob {
    Components x;           ///< positions [m]
    Components u;           ///< velocities [m/s] at the time of the positions
    Window elastic;         ///< forces [N] whose energy is the strain energy; nowhere: not wanted
    Window own;             ///< all others; may be the same arrays
    WeightWindow viscous;   ///< drag weights, see ElementForce::viscosity()
    Sums sums = Sums::none; ///< other than none: the energies, too, and what the next step's are counted from
    Prefetch* prefetch = nullptr;
};

struct GroupEnergy {
    double elastic = 0.; ///< strain energy [J]; only with Sums::energies
    double kink = 0.;    ///< what it grew by in the step beyond the work of its mean force [J]; only with sums

    void add(const GroupEnergy& more) {
        elastic += more.elastic;
        kink += more.kink;
    }
};

/// A moment of a run that is looked at afterwards.
struct Moment {
    const Points &x, &v;  ///< positions [m], velocities [m/s]
    const Points& before; ///< positions a step earlier [m]
};

/// The element that a run's fault is put down to.
struct Culprit {
    std::string element;    ///< as "side" or "node"
    std::vector<int> nodes; ///< that name it
    double weight = -1.;    ///< < 0: none

    /// Takes over what weighs more, or is no number.
    void consider(double other, const char* what, std::initializer_list<int> its) {
        if (other <= weight) return;
        weight = other;
        element = what;
        nodes = its;
    }
};

/// One kind of forces between the nodes of elements. The sweep, the energy ledger, the watch and the critical time step
/// know forces only as this: another one needs nothing of them but a class that is one.
///
/// Forces go to a group of elements at once, see Arrangement: what is called for each element is inlined in the class.
/// Those that have a strain energy go to GroupJob::elastic; the rest is booked under the name of a channel.
class ElementForce {
public:
    virtual ~ElementForce() = default;
    virtual const char* channel() const = 0; ///< of the ledger; the same name, the same channel
    virtual const char* title() const = 0;   ///< in a sentence
    virtual Exchange exchange() const = 0;   ///< of the channel

    virtual void arrange(const Partition& partition) = 0;
    /// Widens the nodes first..last-1 to all that a group writes to, those of padding included.
    virtual void widen(int group, int& first, int& last) const = 0;
    virtual int blocks(int group) const = 0;
    /// Adds the forces of a group.
    virtual GroupEnergy add(int group, const GroupJob& job) = 0;
    /// Not 0: instead of forces it adds weights [m³/s], for which a node at the velocity u is braked by the force
    /// -viscosity weight u. [kg/m³]
    virtual double viscosity() const { return 0.; }

    /// Adds what it means for the critical time step. \param x, v positions [m] and velocities [m/s] of the nodes
    virtual void addTo(LinearForces& to, const Points& x, const Points& v) const = 0;
    /// Where most of the channel's energy is or went in the last step; of the strain energy, if `elastic`. Not asked of
    /// what brings energy.
    virtual Culprit culprit(const Moment&, bool /*elastic*/) const { return {}; }

    // What the kinks of the next step are counted from, if there are such.
    virtual std::size_t memorySize() const { return 0; }
    /// Appends it. There must have been a step with sums, or one of the following two.
    virtual void appendMemory(std::vector<double>&) const {}
    virtual void setMemory(const double*) {}
    /// As if the nodes had been there in the last step [m].
    virtual void setMemoryFrom(const Points&) {}
};

using ElementForces = std::vector<std::shared_ptr<ElementForce>>;

/// Of elements of K corners.
template <std::size_t K> class ArrangedForce : public ElementForce {
public:
    void widen(int group, int& first, int& last) const override {
        for (int b = order_.groups[group]; b < order_.groups[group + 1]; ++b)
            for (const auto& nodes : order_.node)
                for (int e = order_.blocks[b].begin; e < order_.blocks[b].paddedEnd(); ++e) {
                    first = std::min(first, nodes[e]);
                    last = std::max(last, nodes[e] + 1);
                }
    }
    int blocks(int group) const override { return order_.groups[group + 1] - order_.groups[group]; }
    const Arrangement<K>& order() const { return order_; }

protected:
    Arrangement<K> order_;
};

} // namespace membrane
