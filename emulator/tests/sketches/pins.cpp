// Digital inputs, pulls and pin interrupts; pin 13 and pin 2 as outputs.
#include <Arduino.h>

volatile int rising, falling, changes;

void onRising() { rising++; }
void onFalling() { falling++; }
void onChange() { changes++; }

void setup() {
  pinMode(13, OUTPUT);
  pinMode(2, OUTPUT);
  pinMode(3, INPUT);
  pinMode(4, INPUT_PULLUP);
  pinMode(5, INPUT_PULLDOWN);
  pinMode(6, INPUT);
  attachInterrupt(6, onRising, RISING);
  attachInterrupt(7, onFalling, FALLING);
  attachInterrupt(33, onChange, CHANGE);
  digitalWrite(13, HIGH);
  while (!Serial) {
  }
  Serial.printf("idle %d %d %d\n", digitalRead(3), digitalRead(4), digitalRead(5));
  Serial.printf("output %d\n", digitalRead(13));
  digitalWriteFast(2, HIGH);
}

void loop() {
  static uint32_t last;
  if (Serial.available()) {
    Serial.read();
    noInterrupts();
    int r = rising, f = falling, c = changes;
    interrupts();
    Serial.printf("edges %d %d %d levels %d %d %d\n", r, f, c, digitalRead(3), digitalRead(6), digitalRead(33));
  }
  if (millis() - last >= 10) {
    last = millis();
    digitalWrite(13, !digitalRead(13));
  }
}
