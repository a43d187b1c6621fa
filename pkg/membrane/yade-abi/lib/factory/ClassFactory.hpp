// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <abi/Archives.hpp>
#include <lib/base/Math.hpp>
#include <lib/base/Singleton.hpp>

#include <initializer_list>
#include <list>
#include <map>

namespace yade {

class Factorable;

class ClassFactory : public Singleton<ClassFactory> {
    using CreatePure = Factorable* (*)();
    using CreateShared = shared_ptr<Factorable> (*)();
    using CreatePureCustom = void* (*)();
    struct Creators {
        CreatePure pure;
        CreateShared shared;
        CreatePureCustom pureCustom;
    };

    void* dynLibManager_[11];
    std::map<string, Creators> map;

    ClassFactory();
    ClassFactory(const ClassFactory&) = delete;
    virtual ~ClassFactory();

    friend struct abi::Layout<ClassFactory>;
    FRIEND_SINGLETON(ClassFactory)

public:
    bool registerFactorable(string name, CreatePure, CreateShared, CreatePureCustom);
    shared_ptr<Factorable> createShared(string name);
    Factorable* createPure(string name);
    void* createPureCustom(string name);
    bool load(const string& file);
    string lastError();

    // names: the file, the classes, a null pointer
    void registerPluginClasses(const char* names[]);
    // names of all classes that plugins have announced so far
    std::list<string> pluginClasses;

    virtual string getClassName() const;
    virtual string getBaseClassName(int) const;
};

YADE_ABI_LAYOUT(ClassFactory, 168, ((dynLibManager_, 8))((map, 96))((pluginClasses, 144)));

namespace abi {
template <class Class> Factorable* create() {
    return new Class;
}
template <class Class> shared_ptr<Factorable> createShared() {
    return shared_ptr<Class>(new Class);
}
template <class Class> void* createCustom() {
    return new Class;
}

template <class Class> bool registerFactorable(const char* name) {
    return ClassFactory::instance().registerFactorable(name, &create<Class>, &createShared<Class>,
                                                       &createCustom<Class>);
}

inline bool announcePlugin(const char* file, std::initializer_list<const char*> classes) {
    vector<const char*> names(1, file);
    names.insert(names.end(), classes);
    names.push_back(nullptr);
    ClassFactory::instance().registerPluginClasses(names.data());
    return true;
}
} // namespace abi

} // namespace yade

// In namespace yade, after the class: makes it known to the factory when the library is loaded.
#define REGISTER_FACTORABLE(Class)                                                                                     \
    [[maybe_unused]] const bool registered##Class = ::yade::abi::registerFactorable<Class>(#Class);

// In a source file, in namespace yade: YADE_PLUGIN((ClassA)(ClassB)); announces the classes when the library is loaded,
// and makes them known to the archives. Boost's macros do not work inside a namespace, so it is left and reopened.
#define YADE_PLUGIN(classes)                                                                                           \
    }                                                                                                                  \
    namespace {                                                                                                        \
    [[maybe_unused]] const bool BOOST_PP_CAT(announced, BOOST_PP_SEQ_HEAD(classes)) = ::yade::abi::announcePlugin(     \
        __FILE__, {BOOST_PP_SEQ_ENUM(BOOST_PP_SEQ_TRANSFORM(YADE_ABI_PLUGIN_NAME, ~, classes))});                      \
    }                                                                                                                  \
    BOOST_PP_SEQ_FOR_EACH(YADE_ABI_PLUGIN_EXPORT, ~, classes)                                                          \
    namespace yade {
#define YADE_ABI_PLUGIN_NAME(s, data, Class) BOOST_PP_STRINGIZE(Class)
#define YADE_ABI_PLUGIN_EXPORT(r, data, Class)                                                                         \
    BOOST_CLASS_EXPORT_IMPLEMENT(yade::Class) BOOST_SERIALIZATION_FACTORY_0(yade::Class)
