// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Body.hpp>
#include <lib/base/Logging.hpp>

#include <boost/iterator/filter_iterator.hpp>
#include <mutex>

namespace yade {

class InteractionContainer;

// Bodies by id. The slot of an erased body stays, empty; iterators skip it, operator[] does not.
class BodyContainer : public Serializable {
    using ContainerT = vector<shared_ptr<Body>>;
    friend class InteractionContainer;

public:
    struct isNonEmptySharedPtr {
        bool operator()(const shared_ptr<Body>& b) const { return bool(b); }
    };
    using iterator = boost::filter_iterator<isNonEmptySharedPtr, ContainerT::iterator>;

    Body::id_t insert(shared_ptr<Body>);
    Body::id_t insertAtId(shared_ptr<Body>, Body::id_t);
    void clear();
    iterator begin();
    iterator end();
    size_t size() const;
    shared_ptr<Body>& operator[](unsigned int id);
    const shared_ptr<Body>& operator[](unsigned int id) const;
    bool exists(Body::id_t) const;
    bool erase(Body::id_t, bool eraseClumpMembers);
    void updateRealBodies();

    ContainerT body;
    bool dirty;
    bool checkedByCollider;
    vector<Body::id_t> insertedBodies;
    vector<Body::id_t> erasedBodies;
    vector<Body::id_t> realBodies;
    bool useRedirection;
    bool enableRedirection;
    vector<Body::id_t> subdomainBodies;
    std::mutex drawloopmutex;

    virtual ~BodyContainer();
    DECLARE_LOGGER;
    YADE_ABI_SERIALIZABLE

private:
    BodyContainer(); // Scene's
};

YADE_ABI_LAYOUT(BodyContainer, 200,
                ((body, 24))((dirty, 48))((checkedByCollider, 49))((insertedBodies, 56))((erasedBodies, 80))(
                    (realBodies, 104))((useRedirection, 128))((enableRedirection, 129))((subdomainBodies,
                                                                                         136))((drawloopmutex, 160)));
YADE_ABI_SAVED(BodyContainer)

} // namespace yade
