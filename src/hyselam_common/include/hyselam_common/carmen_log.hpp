// Logs of the CARMEN robot navigation toolkit, and the Wean Hall logs of CMU, as plain values.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "hyselam_common/robot_log.hpp"

namespace hyselam {

enum class CarmenClock {
  kLogger,  ///< last field: strictly increasing in a good log [s]
  kIpc,     ///< the field two before: the clock of the recording computer [s]
  kIndex    ///< no clock of the log: message number * `index_period`
};

struct CarmenOptions {
  CarmenClock clock = CarmenClock::kLogger;
  double index_period = 0.1;  ///< between two messages under CarmenClock::kIndex [s], > 0
  /// At or above it a reading means "no return" [m]; 0: from the messages that state it
  /// (ROBOTLASER, RAWLASER), else from the readings, see readCarmenLog().
  double range_max = 0.0;
  double range_min = 0.01;  ///< readings below are invalid [m], > 0
  /// Message that holds the scans ("FLASER", "ROBOTLASER1", "RAWLASER2", "L", ...); empty: the
  /// first of FLASER, ROBOTLASER1, L, RAWLASER1 that the log has.
  std::string scan_message;
};

/// One line that could not be taken as it stands.
struct CarmenIssue {
  enum class Kind {
    kSkipped,  ///< the line is left out
    kRetimed,  ///< the line is kept, its time replaced
    kLog       ///< about the log as a whole; `line` is 0
  };
  std::size_t line = 0;  ///< from 1
  Kind kind = Kind::kSkipped;
  std::string reason;
};

/// "line 12: skipped: 180 readings announced, 35 found".
std::string toString(const CarmenIssue& issue);

/// Reads a log, plain or gzip.
///
/// Scans: FLASER n, ROBOTLASERn and RAWLASERn (old form: count and readings as in FLASER; new form:
/// with the sensor's configuration and remissions), L of the Wean Hall format (centimetres). Where
/// the line does not state angles: start -90 deg; 180/n deg between beams for even n, 180/(n-1) for
/// odd n. Odometry: ODOM, O, and the robot pose carried by the scans; where both fall on one stamp
/// the scan's counts. Ground truth: TRUEPOS. PARAM robot_frontlaser_offset sets laser_in_base.x
/// (its last value counts for the whole log); ROBOTLASER and L state both poses, and there the
/// first scan counts. In corrected logs (with NEFF lines) the ODOM line right after a scan is an
/// artefact and is left out. Other known messages and comments are passed over silently.
///
/// Range limit, if nothing states it: where the readings in the highest 1 % of the range pile up
/// (at least 3, and 10 times as many as in the 1 % below) they are the sensor's "no return", and
/// the smallest of them is range_max; but if they are half of all readings and below 20 m, or do
/// not pile up, every reading is a return.
///
/// Time: within scans, and within odometry, the largest number of lines whose times are in order
/// keep them (scans: strictly); each other line is reported and gets a time between its kept
/// neighbours. Negative times and those above 2^32 - 1 s, which no bag can hold, count as out of
/// order. If fewer than half of the times are in order, the log is read with CarmenClock::kIndex
/// and that is reported.
///
/// Malformed lines (truncated, wrong counts, not a number, unknown message) are reported and
/// skipped. @throws InputError if the file cannot be read or no usable scan is left, ParameterError
/// for options out of range. `issues` may be null.
RobotLog readCarmenLog(const std::string& path, const CarmenOptions& options = {},
                       std::vector<CarmenIssue>* issues = nullptr);

/// The same from text; `source` names it in errors.
RobotLog parseCarmenLog(const std::string& text, const std::string& source,
                        const CarmenOptions& options = {},
                        std::vector<CarmenIssue>* issues = nullptr);

}  // namespace hyselam
