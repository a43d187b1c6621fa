// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/BodyContainer.hpp>
#include <core/Interaction.hpp>
#include <lib/base/Logging.hpp>

#include <mutex>

namespace yade {

// All interactions, potential ones included. A pair of bodies has at most one, whatever the order of the two.
class InteractionContainer : public Serializable {
    using ContainerT = vector<shared_ptr<Interaction>>;
    ContainerT linIntrs;
    ContainerT sortedIntrs;
    const BodyContainer::ContainerT* bodies;
    size_t currSize;
    shared_ptr<Interaction> empty;
    ContainerT interaction;
    friend struct abi::Layout<InteractionContainer>;

public:
    bool dirty;

    void clear();
    using iterator = ContainerT::iterator;
    using const_iterator = ContainerT::const_iterator;
    iterator begin() { return linIntrs.begin(); }
    iterator end() { return linIntrs.end(); }
    const_iterator begin() const { return linIntrs.begin(); }
    const_iterator end() const { return linIntrs.end(); }

    // false if the pair has an interaction already
    bool insert(Body::id_t, Body::id_t);
    bool insert(const shared_ptr<Interaction>&);
    // needs the right Interaction::linIx
    bool erase(Body::id_t, Body::id_t, int linPos = -1);
    // a null pointer if there is none
    const shared_ptr<Interaction>& find(Body::id_t, Body::id_t);
    bool found(const Body::id_t& a, const Body::id_t& b) {
        const Body::id_t low = std::min(a, b), high = std::max(a, b);
        if (low == high || high >= Body::id_t(bodies->size())) return false;
        return (*bodies)[low]->intrs.count(high) > 0;
    }
    shared_ptr<Interaction>& operator[](size_t i) { return linIntrs[i]; }
    const shared_ptr<Interaction>& operator[](size_t i) const { return linIntrs[i]; }
    size_t size() { return currSize; }

    void eraseNonReal();
    std::mutex drawloopmutex;
    bool serializeSorted;
    long iterColliderLastRun;
    // back to a potential interaction
    void requestErase(Body::id_t, Body::id_t);
    void requestErase(const shared_ptr<Interaction>&);
    void requestErase(Interaction*);

    virtual ~InteractionContainer();
    DECLARE_LOGGER;
    YADE_ABI_ATTRIBUTES

private:
    InteractionContainer(); // Scene's
};

YADE_ABI_LAYOUT(InteractionContainer, 192,
                ((linIntrs, 24))((sortedIntrs, 48))((bodies, 72))((currSize, 80))((empty, 88))((interaction, 104))(
                    (dirty, 128))((drawloopmutex, 136))((serializeSorted, 176))((iterColliderLastRun, 184)));
YADE_ABI_SAVED(InteractionContainer)

} // namespace yade
