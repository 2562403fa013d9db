/* The codels of SafetyPilot: speeds pass as long as the way is free, and the robot stops otherwise. */
#include "acSafetyPilot.h"

#include <math.h>

/* Seconds since the beginning, as a stamp. */
static double now(const genom_context self) {
  return (double)self->now_ns * 1e-9;
}

static void stand_still(nav_command *command, const genom_context self) {
  command->taken = now(self);
  command->speed.linear = 0;
  command->speed.angular = 0;
}

/* start of StopIfObstacle: yields inputs */
genom_event PilotStart(const SafetyPilot_Cmd *Cmd, const genom_context self) {
  stand_still(Cmd->data(self), self);
  Cmd->write(self);
  return SafetyPilot_inputs;
}

/* inputs: yields look */
genom_event ReadSpeed(const SafetyPilot_PFCmd *PFCmd, nav_command *wanted, const genom_context self) {
  const nav_command *said;
  PFCmd->read(self);
  said = PFCmd->data(self);
  if (said) {
    *wanted = *said;
  } else {
    stand_still(wanted, self);
  }
  return SafetyPilot_look;
}

/* look: yields check */
genom_event Look(const SafetyPilot_Laser *Laser, nav_scan *scan, const genom_context self) {
  const nav_scan *seen;
  Laser->read(self);
  seen = Laser->data(self);
  if (seen) *scan = *seen;
  return SafetyPilot_check;
}

/* check: yields write_p. What is straight ahead and nearer than the distance stops the robot; it may still turn. */
genom_event CheckWay(const nav_scan *scan, double distance, const nav_command *wanted, nav_command *safe,
                     const genom_context self) {
  uint32_t count = scan->ranges._length, first = count / 3, last = count - count / 3;
  *safe = *wanted;
  safe->taken = now(self);
  for (uint32_t i = first; i < last; i++) {
    if (scan->ranges._buffer[i] < distance && safe->speed.linear > 0) safe->speed.linear = 0;
  }
  return SafetyPilot_write_p;
}

/* write_p: yields pause::inputs */
genom_event WriteCmd(const nav_command *safe, const SafetyPilot_Cmd *Cmd, const genom_context self) {
  *Cmd->data(self) = *safe;
  Cmd->write(self);
  return SafetyPilot_pause_inputs;
}

/* stop: yields ether. Whatever comes after it, the robot stands. */
genom_event ZeroSpeed(const SafetyPilot_Cmd *Cmd, const genom_context self) {
  stand_still(Cmd->data(self), self);
  Cmd->write(self);
  return SafetyPilot_ether;
}
