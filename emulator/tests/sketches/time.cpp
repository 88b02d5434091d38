// Measures delays against the timers, in microseconds.
#include <Arduino.h>

static void report(const char *what, uint32_t start) {
  uint32_t took = micros() - start;
  Serial.print(what);
  Serial.print(' ');
  Serial.println(took);
}

void setup() {
  while (!Serial) {
  }
  uint32_t start = micros();
  delay(1);
  report("delay1", start);
  start = micros();
  delay(100);
  report("delay100", start);
  start = micros();
  delayMicroseconds(50);
  report("delayMicroseconds50", start);
  start = micros();
  delayMicroseconds(1000);
  report("delayMicroseconds1000", start);
  elapsedMillis since;
  while (since < 25) {
  }
  report("elapsed", micros());
  uint32_t ms = millis();
  uint32_t us = micros();
  Serial.print("agree ");
  Serial.println((int)(us / 1000 - ms));
  Serial.print("cpu ");
  Serial.println(F_CPU);
  Serial.println("tick");
  delay(1000);
  Serial.println("tock");
}

void loop() {}
