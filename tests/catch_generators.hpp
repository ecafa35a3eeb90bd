// Catch2's generators of several values (range, take, random). Version 2 has them in its one header; version 3 has headers for them, which
// only these tests compile.
#pragma once

#include <catch.hpp>

#if __has_include(<catch2/generators/catch_generators.hpp>)
#include <catch2/generators/catch_generators_adapters.hpp>
#include <catch2/generators/catch_generators_random.hpp>
#include <catch2/generators/catch_generators_range.hpp>
#endif
