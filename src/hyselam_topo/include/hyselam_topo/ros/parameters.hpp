// Former name of gr2to_parameters.hpp, until 2.0.0.
#pragma once

#include "hyselam_topo/ros/gr2to_parameters.hpp"
