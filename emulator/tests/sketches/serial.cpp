// Prints what a sketch prints, then echoes.
#include <Arduino.h>

void setup() {
  Serial.begin(9600);
  while (!Serial) {
  }
  Serial.println("hello");
  Serial.print("int ");
  Serial.println(-12345);
  Serial.print("hex ");
  Serial.println(0xBEEF, HEX);
  Serial.print("float ");
  Serial.println(3.14159, 4);
  Serial.printf("printf %d %s %08lx\n", 42, "text", 0xCAFEul);
  Serial.print(String("string ") + 7 + '\n');
  Serial.send_now();
  for (int i = 0; i < 500; i++) {
    Serial.print("line ");
    Serial.println(i);
  }
  Serial.println("end of lines");
}

void loop() {
  while (Serial.available()) {
    char c = Serial.read();
    Serial.write(isupper(c) ? tolower(c) : toupper(c));
  }
}
