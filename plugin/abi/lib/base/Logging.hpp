// YADE's logging macros, here one line on the standard error stream with the place it comes from.
#pragma once

#include <iostream>

#define YADE_ABI_LOG(level, message) std::cerr << level << " " << __func__ << ": " << message << std::endl
#define LOG_FATAL(message) YADE_ABI_LOG("FATAL ERROR", message)
#define LOG_ERROR(message) YADE_ABI_LOG("ERROR", message)
#define LOG_WARN(message) YADE_ABI_LOG("WARNING", message)
#define LOG_INFO(message) YADE_ABI_LOG("INFO", message)
#define DECLARE_LOGGER static_assert(true)
#define CREATE_LOGGER(Class) static_assert(true)
