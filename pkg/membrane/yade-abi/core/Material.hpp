// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/State.hpp>
#include <lib/multimethods/Indexable.hpp>
#include <lib/serialization/Serializable.hpp>

namespace yade {

class Scene;

class Material : public Serializable, public Indexable {
public:
    virtual ~Material();
    // the State that a body of this material needs
    virtual shared_ptr<State> newAssocState() const;
    virtual bool stateTypeOk(State*) const;

    // of the current scene unless one is given
    static const shared_ptr<Material> byId(int id, Scene* scene = nullptr);
    static const shared_ptr<Material> byId(int id, shared_ptr<Scene> s) { return byId(id, s.get()); }
    static const shared_ptr<Material> byLabel(const string& label, Scene* scene = nullptr);
    static const shared_ptr<Material> byLabel(const string& label, shared_ptr<Scene> s) {
        return byLabel(label, s.get());
    }
    static int byLabelIndex(const string& label, Scene* scene = nullptr);

    // -1 unless shared, that is in Scene::materials
    int id;
    string label;
    Real density;

    Material() : id(-1), density(1000) {}
    YADE_ABI_SERIALIZABLE
    YADE_ABI_TOP_INDEXABLE
};

YADE_ABI_LAYOUT(Material, 80, ((id, 32))((label, 40))((density, 72)));
YADE_ABI_SAVED(Material)

} // namespace yade
