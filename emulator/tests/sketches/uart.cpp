// Serial1 to Serial3: a greeting each, then echo with the case turned.
#include <Arduino.h>

void setup() {
  Serial1.begin(115200);
  Serial2.begin(38400);
  Serial3.begin(9600);
  while (!Serial) {
  }
  Serial1.println("one");
  Serial2.println("two");
  Serial3.println("three");
  Serial1.flush();
  uint32_t start = micros();
  for (int i = 0; i < 100; i++) Serial1.write('x');
  Serial1.flush();
  Serial.print("hundred us ");
  Serial.println(micros() - start);
}

template <typename Port> static void echo(Port &port) {
  while (port.available()) {
    char c = port.read();
    port.write(toupper(c));
    Serial.write(c);
  }
}

void loop() {
  echo(Serial1);
  echo(Serial2);
  echo(Serial3);
}
