#include "oracle/runge_kutta.hpp"
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>

namespace oracle {

State rungeKutta(const Equation& equation, State state, Long time, Long step)
{
	boost::numeric::odeint::runge_kutta_fehlberg78<State, Long>().do_step(std::cref(equation), state, time, step);
	return state;
}

} // namespace oracle
