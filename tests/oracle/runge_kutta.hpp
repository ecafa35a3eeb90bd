#pragma once
// One step of Runge-Kutta-Fehlberg 7(8) of Boost.Odeint in 64-bit mantissa.
#include <array>
#include <functional>

namespace oracle {

using Long = long double;
using State = std::array<Long, 2>; // an angle and its rate
using Equation = std::function<void(const State&, State& rate, Long time)>;

State rungeKutta(const Equation& equation, State state, Long time, Long step);

} // namespace oracle
