// PWM on all three timers, at several frequencies, and a tone.
#include <Arduino.h>

void setup() {
  analogWrite(22, 64);
  analogWriteFrequency(3, 1000);
  analogWrite(3, 128);
  analogWriteFrequency(32, 10);
  analogWriteResolution(12);
  analogWrite(32, 1024);
  while (!Serial) {
  }
  // The same pulses, seen through the pin.
  uint32_t high = 0, total = 20000;
  for (uint32_t i = 0; i < total; i++) {
    high += digitalRead(3);
    delayMicroseconds(3);
  }
  Serial.printf("share %lu\n", high * 100 / total);
  tone(2, 440, 100);
  uint32_t edges = 0, start = millis();
  int level = digitalRead(2);
  while (millis() - start < 150) {
    int now = digitalRead(2);
    edges += now != level;
    level = now;
  }
  Serial.printf("tone %lu\n", edges);
}

void loop() {}
