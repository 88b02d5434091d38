// Nothing special: the core itself listens for 134 baud.
#include <Arduino.h>

void setup() {
  while (!Serial) {
  }
  Serial.println("ready");
}

void loop() {}
