// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <iostream>
#include <sstream>
#include <type_traits>

// YADE logs through objects named `logger`, one per class. Here the name must be in scope, as it must there, but
// messages of level WARN and above go straight to the standard error stream, and the rest is dropped (YADE's default).

namespace yade {
namespace abi {
struct Logger {};
} // namespace abi
} // namespace yade

#define DECLARE_LOGGER                                                                                                 \
public:                                                                                                                \
    static constexpr ::yade::abi::Logger logger {}
#define CREATE_LOGGER(Class)                                                                                           \
    static_assert(std::is_same_v<decltype(Class::logger), const ::yade::abi::Logger>, #Class " needs DECLARE_LOGGER")
#define CREATE_CPP_LOCAL_LOGGER(name)                                                                                  \
    namespace {                                                                                                        \
    [[maybe_unused]] constexpr ::yade::abi::Logger logger{};                                                           \
    }

// One write per message, since functors log from several threads.
#define YADE_ABI_LOG(wanted, level, message)                                                                           \
    {                                                                                                                  \
        static_assert(std::is_same_v<decltype(logger), const ::yade::abi::Logger>);                                    \
        if (wanted) {                                                                                                  \
            std::ostringstream text_;                                                                                  \
            text_ << level " " __FILE__ ":" << __LINE__ << " " << __func__ << ": " << message << "\n";                 \
            std::cerr << text_.str() << std::flush;                                                                    \
        }                                                                                                              \
    }

#define LOG_NOFILTER(message) YADE_ABI_LOG(true, "NOFILTER", message)
#define LOG_FATAL(message) YADE_ABI_LOG(true, "FATAL", message)
#define LOG_ERROR(message) YADE_ABI_LOG(true, "ERROR", message)
#define LOG_WARN(message) YADE_ABI_LOG(true, "WARN", message)
#define LOG_INFO(message) YADE_ABI_LOG(false, "INFO", message)
#define LOG_DEBUG(message) YADE_ABI_LOG(false, "DEBUG", message)
#define LOG_TRACE(message) YADE_ABI_LOG(false, "TRACE", message)
