// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include <core/GlobalEngine.hpp>

namespace yade {

class MembraneFault : public GlobalEngine {
public:
    void action() override;

    /// Notes a fault met inside a functor, where an exception would end the process: a MembraneForceEngine raises it in
    /// the same step, or, where there is none, a MembraneFault at the beginning of the next. Safe from any thread.
    static void note(Scene& scene, const std::string& what);
    /// \throws std::runtime_error with what was noted in this step, if anything was; forgets it
    static void raise(Scene& scene);

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS(MembraneFault, GlobalEngine,
        "Raises what a functor of the membrane has met and could not raise itself, as RuntimeError, and leaves O.engines. Functors put it there.",
        ((string, message, , Attr::readonly, "What was met first."))
        ((int, count, 0, Attr::readonly, "How many faults were met [-]."))
    );
    // clang-format on

private:
    [[noreturn]] void stop() const;
};
REGISTER_SERIALIZABLE(MembraneFault);

} // namespace yade
