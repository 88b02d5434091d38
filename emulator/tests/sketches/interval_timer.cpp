// Four interval timers at once; the cycle counter says when each call came.
#include <Arduino.h>

IntervalTimer timers[4];
volatile uint32_t calls[4];
volatile uint32_t first, last;

void tick0() {
  uint32_t now = ARM_DWT_CYCCNT;
  if (calls[0] == 0) first = now;
  last = now;
  calls[0]++;
}
void tick1() { calls[1]++; }
void tick2() { calls[2]++; }
void tick3() { calls[3]++; }

void setup() {
  while (!Serial) {
  }
  ARM_DEMCR |= ARM_DEMCR_TRCENA;
  ARM_DWT_CTRL |= ARM_DWT_CTRL_CYCCNTENA;
  timers[0].priority(0);
  timers[0].begin(tick0, 100);
  timers[1].begin(tick1, 1000);
  timers[2].begin(tick2, 2500);
  timers[3].begin(tick3, 33.25f);
  delay(100);
  for (auto &timer : timers) timer.end();
  noInterrupts();
  uint32_t count = calls[0] - 1, span = last - first;
  interrupts();
  Serial.print("period ");
  Serial.println(span / count);
  for (int i = 0; i < 4; i++) {
    Serial.print("calls ");
    Serial.println(calls[i]);
  }
  IntervalTimer fifth;
  Serial.print("again ");
  Serial.println(fifth.begin(tick1, 1000));
}

void loop() {}
