// The wire messages of the cell (Calvo et al. 2013, Table 4, plus appended members) as plain structs.
// Owned by whoever holds them.
// Any thread but a scan thread (they allocate).
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "scan/figures.hpp"

namespace stationd::bus {

/// Topic `Set`, type PV_Set. Table 4 ends after CODE.
struct Set {
  std::string STATION;
  std::uint32_t CODE = 0;
  bool ERROR = false;
  std::uint32_t STATUS = 0;
  std::uint32_t EPOCH = 0;
  std::uint32_t SEQ = 0;
};

/// Topic `End`, type PV_End. Table 4 ends after STATUS.
struct End {
  std::string STATION;
  std::uint32_t CODE = 0;
  bool ERROR = false;
  std::uint32_t STATUS = 0;
  std::uint32_t EPOCH = 0;
  std::uint32_t SEQ = 0;
};

/// Topic `GSE`, type ASE_GSE (no key). Table 4 ends after STATUS; STATUS is the code.
struct Gse {
  bool ERROR = false;        ///< an active fault or warning
  std::uint32_t STATUS = 0;  ///< code, see scan/codes.hpp
  std::string STATION;
  std::uint32_t EPOCH = 0;
  std::uint32_t SEQ = 0;
  std::uint32_t SEVERITY = 0;    ///< 0 info, 1 warning, 2 fault
  bool ACTIVE = false;           ///< rising (true) or falling
  bool EDGE = true;              ///< false: announced as still active after a restart
  std::int64_t SOURCE_TIME = 0;  ///< UTC nanoseconds
  std::int64_t DETAIL = 0;
  std::string TEXT;  ///< the code's name; for one that was lost ": " and its name
};

enum class Order : std::uint32_t { START = 0, STOP = 1, MSG = 2 };

/// Topics `Start`, `Stop`, `Msg_Req`, type Msg_Req (keys DEST_STATION, ORDER).
struct MsgReq {
  std::string DEST_STATION;
  std::string BODY;
  Order ORDER = Order::MSG;
};

/// Topic `Msg_Res`, type Msg_Res (no key). DEST_STATION is the requester's name.
struct MsgRes {
  std::string DEST_STATION;
  std::uint32_t CODE = 0;
  bool ERROR = false;
  std::uint32_t STATUS = 0;
  std::string BODY;
};

/// Topic `Status`, type PV_Status (key STATION).
struct Status {
  std::string STATION;
  std::uint32_t STATE = 0;  ///< 0 STOPPED, 1 RUNNING, 2 STOPPING, 3 FAULT
  std::uint32_t EPOCH = 0;
  bool READY = false;
  std::uint32_t FAULT = 0;  ///< active fault's code; 0: none
  std::string CONTROLLER;
  std::uint64_t SCANS = 0;
  std::uint64_t DEADLINE_MISSES = 0;
  std::uint32_t WARNING = 0;     ///< an active warning's code; 0: none
  std::uint32_t STOP_CAUSE = 0;  ///< in STOPPED: 0 never started, 1 ordered, 2 after a fault
  std::uint32_t STEP = 0;
  std::string STEP_NAME;
  std::uint32_t PIECE = 0;  ///< code of the piece in work; 0: none
  std::int64_t PERIOD_NS = 0;
  std::int64_t LATENESS_P99_NS = 0;
  std::int64_t LATENESS_MAX_NS = 0;
  std::string REALTIME;          ///< what was granted and refused, for people
  std::int64_t SOURCE_TIME = 0;  ///< UTC nanoseconds
  std::uint32_t FORCED = 0;      ///< inputs and outputs that an operator forces
};

/// Topic `ScanStats`, type PV_ScanStats (key STATION): how a station's scans keep their time. Counters are
/// those of its task, since start and for the last minute.
struct ScanStats {
  std::string STATION;
  std::string TASK;
  std::uint32_t TASK_STATIONS = 0;  ///< in that task
  std::int64_t PERIOD_NS = 0;
  std::uint64_t SCANS = 0;
  std::uint64_t DEADLINE_MISSES = 0;
  std::uint64_t SKIPPED = 0;
  std::uint64_t MINUTE_SCANS = 0;
  std::uint64_t MINUTE_DEADLINE_MISSES = 0;
  std::uint64_t MINUTE_SKIPPED = 0;
  std::int64_t SOURCE_TIME = 0;  ///< UTC nanoseconds
  /// By Window and Figure. On the wire one member each: LATENESS, EXECUTION, ..., MINUTE_LATENESS, ...
  std::array<std::array<Summary, kFigures>, kWindows> FIGURES{};
};

}  // namespace stationd::bus
