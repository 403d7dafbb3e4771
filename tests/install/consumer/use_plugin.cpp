int check_plugin();

int main() {
  return check_plugin();
}
