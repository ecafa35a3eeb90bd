#include "dynamics/rigid/contact_problem.hpp"
