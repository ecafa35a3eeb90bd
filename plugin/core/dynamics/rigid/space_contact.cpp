#include "dynamics/rigid/kinematics.hpp"
