// YADE's logging macros, here one line of words on the standard error stream, as what masonry.dem prints.
#pragma once

#include <iostream>

#define YADE_ABI_LOG(level, message) std::cerr << "masonry.dem: " << level << ": " << message << std::endl
#define LOG_FATAL(message) YADE_ABI_LOG("fatal error", message)
#define LOG_ERROR(message) YADE_ABI_LOG("error", message)
#define LOG_WARN(message) YADE_ABI_LOG("warning", message)
#define LOG_INFO(message) YADE_ABI_LOG("info", message)
#define DECLARE_LOGGER static_assert(true)
#define CREATE_LOGGER(Class) static_assert(true)
