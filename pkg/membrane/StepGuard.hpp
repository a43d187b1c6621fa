// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

namespace yade {

class Engine;

/// One lock for all of the plugin that other threads can call while YADE runs a scene in the background, as Python and
/// the 3D view do: they get in when the running step arrives at an engine of membrane forces, where all bodies are at
/// the same time, or at once where nothing runs.
class StepGuard {
public:
    /// To be kept while an engine computes.
    class Step {
    public:
        Step();
        ~Step();
        Step(const Step&) = delete;
        Step& operator=(const Step&) = delete;
    };

    /// To be kept while looking, or changing what steps look at. Does nothing in the thread that steps.
    class Look {
    public:
        /// \param between waits for the place between two steps; false: only until no engine computes
        explicit Look(bool between = true);
        ~Look();
        Look(const Look&) = delete;
        Look& operator=(const Look&) = delete;

    private:
        bool holds_;
        unsigned long number_ = 0;
    };

    /// Keeps the running step where it is until this thread gives up Python's lock: while a scene is being saved.
    static void holdForSave();
    /// Whether a scene is running in another thread.
    static bool othersRun();
    /// Refuses an engine's action that Python calls while a scene is running.
    /// \throws std::runtime_error naming the engine
    static void refuseCall(const Engine& engine);
};

/// A member function behind a StepGuard::Look, to be called from Python.
template <auto member> struct Guarded;
template <class Class, class Result, class... Arguments, Result (Class::*member)(Arguments...)> struct Guarded<member> {
    static Result call(Class& object, Arguments... arguments) {
        const StepGuard::Look look;
        return (object.*member)(arguments...);
    }
};
template <class Class, class Result, class... Arguments, Result (Class::*member)(Arguments...) const>
struct Guarded<member> {
    static Result call(const Class& object, Arguments... arguments) {
        const StepGuard::Look look;
        return (object.*member)(arguments...);
    }
};

} // namespace yade
