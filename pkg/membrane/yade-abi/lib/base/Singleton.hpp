// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#define FRIEND_SINGLETON(Class) friend class Singleton<Class>;

// In the global namespace, as in YADE; the instances for Omega and ClassFactory are in libyade.
template <class T> class Singleton {
protected:
    static T* self;

public:
    static T& instance();
};
