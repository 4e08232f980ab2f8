// All that the page says, in English and Portuguese.
import {remembered, remember} from "./dom.js";

const TEXTS = {
  en: {
    title: "Robot", skip_to_talk: "Skip to the talk", change_language: "Mudar para português", other_language: "PT",
    map_label: "Map of the building", map_keys: "Arrow keys move the map, plus and minus zoom, 0 shows all of it, R goes to the robot, Enter opens the place in the middle. All places are also in the list Places.",
    map_empty: "There is no map yet. It grows as the robot drives.", map_login: "Log in to see the map.", zoom_in: "Zoom in", zoom_out: "Zoom out", fit_map: "Show the whole map", follow_robot: "Stay with the robot",
    talk_label: "The talk with the robot", suggestions: "Suggestions", say_label: "Say something to the robot", say_placeholder: "Say something…", answer_placeholder: "Your answer…",
    send: "Send", listen: "Speak instead of typing", listening: "Listening: speak now…", mic_refused: "The microphone was refused. Allow it for this page in the browser’s settings.", mic_missing: "No microphone was found.", mic_nothing: "Nothing was heard. Try again, nearer to the microphone.", mic_service: "This browser does not recognise speech. Type, or use the microphone of your keyboard.", mic_insecure: "The browser gives the microphone only to pages of https. Type, or use the microphone of your keyboard.", yes: "Yes", no: "No", stop: "STOP", undo: "Undo",
    tabs_label: "Views", tab_talk: "Talk", tab_places: "Places", tab_robot: "Robot", tab_back: "History",
    welcome: "Tell the robot about the building, as you would tell a visitor. The names appear on the map.",
    login_title: "Password, please", login_text: "STOP works without it.", login_token: "Password", login_go: "Open", login_wrong: "That is not the password.", login_often: "Too many tries. Wait a moment.",
    lost_connection: "No connection: what you see may be old. Trying again…", lost_master: "The robot's computer does not answer. What you see may be old.",
    not_connected: "Not connected: it was not sent.", stop_sent: "Stop was sent.", stop_failed: "STOP WAS NOT SENT: there is no connection!", stop_unheard: "Stop was sent, but NOBODY HEARS IT: neither the dialogue nor the navigation runs!",
    in_place: "In: {name}", in_doorway: "In the doorway: {name}", nowhere: "Its place is not known", phase_search: "looking for itself", phase_lost: "lost", phase_sure: "it knows where it is", going: "on its way", arrived: "it has arrived", arrived_at: "It has arrived: {name}.", stop_said: "Stop.", following: "following a person", trouble: "something is wrong: see Robot", replay_at: "Replay {time}", stop_robot: "STOP the real robot", stop_real: "Stop was sent to the real robot. What you see is a recording.",
    place_of: "Place {n}", place_number: "place {n}", named_guess: "A guess, from what it was told.", named_sure: "Its name is confirmed.", unnamed: "It has no name yet.", kind_0: "A room", kind_1: "A corridor", kind_2: "A part of a room", about: "{kind} of about {area} m².", robot_is_here: "The robot is here.",
    beside: "Through a door: {names}.", behind: "Behind the wall: {names}.", things: "Things here: {names}.", asked_here: "The robot asks about this place.",
    next_label: "What you can do next", did_you_mean: "Did you mean:", where_is_it: "Where is {name}?", where_are_they: "Where are {name}?", where_then: "Where is {name} then?", where_are_then: "Where are {name} then?", is_it: "Is place {n} {name}?", right_place: "Yes, {place}", other_place: "Another place…", tap_place: "Tap it on the map…", not_now: "Not now", this_is: "This is {name}", show_where: "Show where {name} is",
    tool_pick: "Tap the place of {name} on the map.", tool_pick_keys: "With keys: move the map, Enter.",
    kinds: "kitchen, office, library, bathroom, toilet, restroom, corridor, hallway, lobby, laboratory, workshop, reception, entrance, elevator, stairs, meeting room, classroom, storage room, bedroom, living room, dining room, garage, canteen, cafeteria, archive, waiting room, printer room, server room, secretary",
    right_name: "Yes, right", wrong_name: "No", go_there: "Go there", name_it: "Name it", rename_it: "Rename", ask_about: "What is next to it?", here_you_are: "Set robot here", name_label: "Name of the place", save_name: "Save", forget_name: "Forget the name", cancel: "Cancel", close: "Close", examples: "e.g. kitchen",
    doors: "Doors", door_to: "Door to {name}", shut: "Treat as shut", shut_done: "The robot treats this door as shut. Its card opens it again.", door_closed: "was closed when last seen",
    unshut: "Treat as open", unshut_done: "The robot treats this door as open again.", door_shut: "treated as shut", doors_and_walls: "Doors and walls", glass_wall: "Glass wall", virtual_wall: "Wall that was told of", unwall: "Take away", unwalled: "The wall is there no more.",
    here_sure: "Is the robot really here: {name}? It starts anew from the middle of it.", here_yes: "Yes, it is here",
    name_taken: "“{name}” is the name of {place}. Shall that name move here? There, it is gone then.", move_name: "Move the name here",
    name_doubted: "“{name}” looks like something to say to the robot. Is it really the name of this place?", name_anyway: "Yes, its name",
    what_next: "What is next to {name}?", undo_sentence: "Undo that.", undo_what: "Undo: {what}", show_place: "Show place {n}", carry_on: "Carry on.", carry_on_to: "Carry on to {name}",
    no_places: "No places yet: the robot finds them in its map.", no_match: "Nothing here has that in its name.", search_places: "Search", objects: "Things", no_objects: "Nothing was told or seen yet.", seen: "on the map", told: "told", thing_seen: "It was seen there.", thing_told: "It was told of, not seen: on the map only its place is right.", forget_thing: "It is not there any more", forget_this: "Forget the {name}.", there_again: "The {name} is in \"{place}\".", no_name: "no name yet",
    pose_title: "Where it is", camera_title: "What the camera thinks", camera_nothing: "The picture shows no place in particular.", layers_title: "Parts of the robot", do_title: "Do", page_title: "This page",
    set_pose: "Tell the robot where it is", draw_wall: "Draw a glass wall", check: "Check everything", checking: "Checking, 5 seconds…", save: "Save what it knows", saving: "Saving…", saved: "Saved.", learn: "Learn how places look", unlearn: "Stop learning", learning: "It is learning.", not_learning: "It has stopped learning.",
    all_right: "Nothing is wrong.", speak: "Read answers aloud", theme: "Light or dark", logout: "Log out", no_layers: "No part reports anything.",
    layer_slam: "Draws the map", layer_localization: "Knows where it is", layer_fsd: "Finds itself when it is lost", layer_words: "Remembers its ways", layer_gr2to: "Finds the rooms on the map", layer_topo_engine: "Talks and keeps the names", layer_semantic_localization: "Knows places by their look", layer_object_engine: "Knows things", layer_map_server: "Shows the map",
    level_ok: "works", level_warn: "works, but has something to say", level_error: "does not work", level_stale: "says nothing", technical: "Details for technicians", map_refused: "The new map cannot be shown.",
    found_WRONG: "{what}: something is wrong.", found_note: "{what}: worth a look.", about_tf: "How its parts stand to each other", about_scan: "Laser", about_laser: "Mounting of the laser", about_clock: "Clock", about_map: "Map", about_odometry: "Wheels", about_nodes: "Programs", about_camera: "Camera", about_topics: "Connections between its parts", about_diagnostics: "Report of a part", about_other: "Another part", see_technical: "What it says is in the details for technicians below.",
    advice_tf: "Start the robot again. If that does not help, ask a technician.", advice_scan: "See whether the laser has power and nothing covers its window. Then check again.", advice_laser: "See whether the laser still sits straight and where it was. Then ask a technician.", advice_clock: "The clocks of the robot’s computers differ. Start it again, with a network.", advice_map: "Drive the robot around slowly, or load a map that was saved.", advice_odometry: "See whether the wheels are free and do not slip. Then check again.", advice_nodes: "A program does not run. Start the robot again.", advice_camera: "See whether the camera is plugged in and clean. Without it the robot drives, but knows no places by their look.", advice_topics: "A part gets nothing from another one. Start the robot again; if that does not help, ask a technician.", advice_diagnostics: "See the list of parts below: one of them says more.", advice_other: "Show a technician the details below.",
    tool_pose: "Touch where the robot is and drag towards where it looks.", tool_wall: "Drag from one end of the glass to the other.", tool_keys: "With keys: move the map, Enter, move, Enter.", tool_second: "Now the other end: Enter.", pose_sent: "Thank you. The robot starts from there.", wall_sent: "The glass wall is on the map. The card of its room takes it away.",
    reports: "Reports", no_reports: "There are no reports here.", watch: "Watch this day again", watch_text: "Everything that this page showed since the robot was started.", back_live: "Back to now", play: "Play", pause: "Pause", time_label: "Time of the day", speed_label: "Speed", replay: "Recording", no_recording: "There is no recording.",
    error_too_often: "Too much at once. Wait a moment.", error_stopped: "Not said: the robot was stopped meanwhile.", error_not_allowed: "You are not allowed to do that.", error_nobody: "That part of the robot does not run.", error_no_answer: "The robot did not answer in time.", error_busy: "The robot is busy. Try again.", error_failed: "That did not work.", error_invalid: "That is not possible.", error_unknown: "That is not there any more.", error_malformed: "That was not understood.",
    start_where: "Where are you?", start_in: "You are in the ", start_left: "On your left you have ", start_right: "On your right you have ", start_this: "This is the ", start_go: "Go to ", start_help: "Help", start_told: "What have I told you?",
  },
  pt: {
    title: "Robô", skip_to_talk: "Saltar para a conversa", change_language: "Switch to English", other_language: "EN",
    map_label: "Mapa do edifício", map_keys: "As setas movem o mapa, mais e menos ampliam, 0 mostra tudo, R mostra o robô, Enter abre o lugar do meio. Todos os lugares estão também na lista Lugares.",
    map_empty: "Ainda não há mapa. Cresce quando o robô anda.", map_login: "Introduza a senha para ver o mapa.", zoom_in: "Ampliar", zoom_out: "Reduzir", fit_map: "Mostrar o mapa todo", follow_robot: "Acompanhar o robô",
    talk_label: "A conversa com o robô", suggestions: "Sugestões", say_label: "Diga algo ao robô", say_placeholder: "Diga algo…", answer_placeholder: "A sua resposta…",
    send: "Enviar", listen: "Falar em vez de escrever", listening: "A ouvir: pode falar…", mic_refused: "O microfone foi recusado. Autorize-o para esta página nas definições do navegador.", mic_missing: "Não foi encontrado nenhum microfone.", mic_nothing: "Não se ouviu nada. Tente de novo, mais perto do microfone.", mic_service: "Este navegador não reconhece a fala. Escreva, ou use o microfone do teclado.", mic_insecure: "O navegador só dá o microfone a páginas https. Escreva, ou use o microfone do teclado.", yes: "Sim", no: "Não", stop: "PARAR", undo: "Desfazer",
    tabs_label: "Vistas", tab_talk: "Conversa", tab_places: "Lugares", tab_robot: "Robô", tab_back: "Histórico",
    welcome: "Descreva o edifício ao robô, como a uma visita. Os nomes aparecem no mapa.",
    login_title: "Senha, por favor", login_text: "PARAR funciona sem ela.", login_token: "Senha", login_go: "Abrir", login_wrong: "A senha não está certa.", login_often: "Demasiadas tentativas. Espere um momento.",
    lost_connection: "Sem ligação: o que vê pode ser antigo. Nova tentativa em breve…", lost_master: "O computador do robô não responde. O que vê pode ser antigo.",
    not_connected: "Sem ligação: não foi enviado.", stop_sent: "A ordem de parar foi enviada.", stop_failed: "A ORDEM DE PARAR NÃO FOI ENVIADA: não há ligação!", stop_unheard: "A ordem de parar foi enviada, mas NINGUÉM A OUVE: nem o diálogo nem a navegação funcionam!",
    in_place: "Em: {name}", in_doorway: "À porta: {name}", nowhere: "Não se sabe onde está", phase_search: "procura onde está", phase_lost: "perdido", phase_sure: "sabe onde está", going: "a caminho", arrived: "chegou", arrived_at: "Chegou: {name}.", stop_said: "Parar.", following: "segue uma pessoa", trouble: "há algo errado: veja Robô", replay_at: "Gravação {time}", stop_robot: "PARAR o robô real", stop_real: "A ordem de parar foi enviada ao robô real. O que vê é uma gravação.",
    place_of: "Lugar {n}", place_number: "lugar {n}", named_guess: "Um palpite, pelo que lhe disseram.", named_sure: "O nome está confirmado.", unnamed: "Ainda não tem nome.", kind_0: "Uma sala", kind_1: "Um corredor", kind_2: "Uma parte de uma sala", about: "{kind} de cerca de {area} m².", robot_is_here: "O robô está aqui.",
    beside: "Por uma porta: {names}.", behind: "Atrás da parede: {names}.", things: "Coisas aqui: {names}.", asked_here: "O robô pergunta por este lugar.",
    next_label: "O que pode fazer a seguir", did_you_mean: "Queria dizer:", where_is_it: "Onde fica {name}?", where_are_they: "Onde ficam {name}?", where_then: "Então onde fica {name}?", where_are_then: "Então onde ficam {name}?", is_it: "O lugar {n} é {name}?", right_place: "Sim, {place}", other_place: "Outro lugar…", tap_place: "Tocar no mapa…", not_now: "Agora não", this_is: "Este lugar é {name}", show_where: "Mostrar onde fica {name}",
    tool_pick: "Toque no mapa, no lugar de {name}.", tool_pick_keys: "Com teclas: mover o mapa, Enter.",
    kinds: "cozinha, escritório, gabinete, biblioteca, banheiro, casa de banho, lavabo, corredor, átrio, laboratório, oficina, receção, recepção, entrada, elevador, escadas, escada, sala de reuniões, sala de aula, arrecadação, depósito, quarto, sala de estar, sala de jantar, garagem, cantina, refeitório, arquivo, sala de espera, secretaria",
    right_name: "Sim, certo", wrong_name: "Não", go_there: "Ir para lá", name_it: "Dar nome", rename_it: "Mudar o nome", ask_about: "O que há ao lado?", here_you_are: "Pôr o robô aqui", name_label: "Nome do lugar", save_name: "Guardar", forget_name: "Esquecer o nome", cancel: "Cancelar", close: "Fechar", examples: "ex.: cozinha",
    doors: "Portas", door_to: "Porta para {name}", shut: "Tratar como fechada", shut_done: "O robô trata esta porta como fechada. No seu cartão volta a abrir-se.", door_closed: "estava fechada quando a viu",
    unshut: "Tratar como aberta", unshut_done: "O robô volta a tratar esta porta como aberta.", door_shut: "tratada como fechada", doors_and_walls: "Portas e paredes", glass_wall: "Parede de vidro", virtual_wall: "Parede que foi dita", unwall: "Retirar", unwalled: "A parede já não está lá.",
    here_sure: "O robô está mesmo aqui: {name}? Recomeça a partir do meio.", here_yes: "Sim, está aqui",
    name_taken: "“{name}” é o nome do {place}. Mudar o nome para aqui? Lá deixa de existir.", move_name: "Mudar para aqui",
    name_doubted: "“{name}” parece algo que se diz ao robô. É mesmo o nome deste lugar?", name_anyway: "Sim, é o nome",
    what_next: "O que há ao lado de {name}?", undo_sentence: "Desfaça isso.", undo_what: "Desfazer: {what}", show_place: "Mostrar o lugar {n}", carry_on: "Continue.", carry_on_to: "Continuar: {name}",
    no_places: "Ainda não há lugares: o robô encontra-os no mapa.", no_match: "Nada aqui tem isso no nome.", search_places: "Procurar", objects: "Coisas", no_objects: "Ainda nada foi dito nem visto.", seen: "no mapa", told: "dito", thing_seen: "Foi visto ali.", thing_told: "Foi dito, não visto: no mapa só o lugar está certo.", forget_thing: "Já não está lá", forget_this: "Esqueça {name}.", there_again: "{name} está em \"{place}\".", no_name: "ainda sem nome",
    pose_title: "Onde está", camera_title: "O que a câmara pensa", camera_nothing: "A imagem não mostra nenhum lugar em particular.", layers_title: "Partes do robô", do_title: "Fazer", page_title: "Esta página",
    set_pose: "Dizer ao robô onde está", draw_wall: "Desenhar parede de vidro", check: "Verificar tudo", checking: "Verificação em curso, 5 segundos…", save: "Guardar o que sabe", saving: "Um momento…", saved: "Guardado.", learn: "Aprender o aspeto dos lugares", unlearn: "Parar de aprender", learning: "Aprende a partir de agora.", not_learning: "Parou de aprender.",
    all_right: "Está tudo bem.", speak: "Ler as respostas em voz alta", theme: "Claro ou escuro", logout: "Sair", no_layers: "Nenhuma parte diz nada.",
    layer_slam: "Desenha o mapa", layer_localization: "Sabe onde está", layer_fsd: "Encontra-se quando está perdido", layer_words: "Lembra-se dos caminhos", layer_gr2to: "Encontra as salas no mapa", layer_topo_engine: "Conversa e guarda os nomes", layer_semantic_localization: "Conhece lugares pelo aspeto", layer_object_engine: "Conhece coisas", layer_map_server: "Mostra o mapa",
    level_ok: "funciona", level_warn: "funciona, mas tem algo a dizer", level_error: "não funciona", level_stale: "não diz nada", technical: "Pormenores para técnicos", map_refused: "O novo mapa não pode ser mostrado.",
    found_WRONG: "{what}: há algo errado.", found_note: "{what}: convém ver.", about_tf: "Posição das partes entre si", about_scan: "Laser", about_laser: "Montagem do laser", about_clock: "Relógio", about_map: "Mapa", about_odometry: "Rodas", about_nodes: "Programas", about_camera: "Câmara", about_topics: "Ligações entre as partes", about_diagnostics: "Aviso de uma parte", about_other: "Outra parte", see_technical: "O que diz está nos pormenores para técnicos, abaixo.",
    advice_tf: "Ligue o robô de novo. Se não ajudar, chame um técnico.", advice_scan: "Veja se o laser tem corrente e se nada tapa a sua janela. Depois verifique de novo.", advice_laser: "Veja se o laser ainda está direito e no seu lugar. Depois chame um técnico.", advice_clock: "Os relógios dos computadores do robô não coincidem. Ligue-o de novo, com rede.", advice_map: "Conduza o robô devagar pelo edifício, ou carregue um mapa guardado.", advice_odometry: "Veja se as rodas estão livres e não escorregam. Depois verifique de novo.", advice_nodes: "Há um programa parado. Ligue o robô de novo.", advice_camera: "Veja se a câmara está ligada e limpa. Sem ela o robô anda, mas não conhece lugares pelo aspeto.", advice_topics: "Uma parte não recebe nada de outra. Ligue o robô de novo; se não ajudar, chame um técnico.", advice_diagnostics: "Veja a lista das partes, abaixo: uma delas diz mais.", advice_other: "Mostre os pormenores abaixo a um técnico.",
    tool_pose: "Toque onde o robô está e arraste na direção em que olha.", tool_wall: "Arraste de uma ponta do vidro à outra.", tool_keys: "Com teclas: mover o mapa, Enter, mover, Enter.", tool_second: "Agora a outra ponta: Enter.", pose_sent: "Obrigado. O robô parte daí.", wall_sent: "A parede de vidro está no mapa. O cartão da sua sala retira-a.",
    reports: "Relatórios", no_reports: "Aqui não há relatórios.", watch: "Rever este dia", watch_text: "Tudo o que esta página mostrou desde que o robô foi ligado.", back_live: "Voltar ao presente", play: "Reproduzir", pause: "Pausa", time_label: "Hora do dia", speed_label: "Velocidade", replay: "Gravação", no_recording: "Não há gravação.",
    error_too_often: "Demasiado de uma vez. Espere um momento.", error_stopped: "Não foi dito: entretanto o robô foi mandado parar.", error_not_allowed: "Não tem permissão para isso.", error_nobody: "Essa parte do robô não está a funcionar.", error_no_answer: "O robô não respondeu a tempo.", error_busy: "O robô está ocupado. Tente de novo.", error_failed: "Não resultou.", error_invalid: "Isso não é possível.", error_unknown: "Isso já não existe.", error_malformed: "Não se percebeu.",
    start_where: "Onde está?", start_in: "Está no ", start_left: "À sua esquerda tem ", start_right: "À sua direita tem ", start_this: "Esta é a ", start_go: "Vá para ", start_help: "Ajuda", start_told: "O que lhe disse?",
  },
};

let language = "en";
const listeners = [];

export function currentLanguage() {
  return language;
}

export function t(key, values = {}, of_language = language) {
  const text = TEXTS[of_language][key] ?? TEXTS.en[key];
  if (text === undefined) throw new Error(`no text ${key}`);
  return text.replace(/\{(\w+)\}/g, (whole, name) => (name in values ? String(values[name]) : whole));
}

export function onLanguage(listener) {
  listeners.push(listener);
}

function translatePage() {
  document.documentElement.lang = language;
  document.title = t("title");
  for (const element of document.querySelectorAll("[data-t]")) element.textContent = t(element.dataset.t);
  for (const element of document.querySelectorAll("[data-label]")) {
    element.setAttribute("aria-label", t(element.dataset.label));
    if (element.tagName === "BUTTON") element.title = t(element.dataset.label);
  }
  for (const element of document.querySelectorAll("[data-placeholder]")) element.placeholder = t(element.dataset.placeholder);
}

export function setLanguage(wanted, keep = false) {
  language = wanted in TEXTS ? wanted : "en";
  if (keep) remember("language", language);
  translatePage();
  for (const listener of listeners) listener();
}

// What was chosen here before, what the browser prefers, what the robot begins with.
export function firstLanguage(robots) {
  const chosen = remembered("language");
  if (chosen in TEXTS) return chosen;
  for (const preferred of navigator.languages ?? []) {
    const short = preferred.slice(0, 2).toLowerCase();
    if (short in TEXTS) return short;
  }
  return robots;
}

export function missingTexts() {
  return Object.keys(TEXTS.en).filter((key) => !(key in TEXTS.pt)).concat(Object.keys(TEXTS.pt).filter((key) => !(key in TEXTS.en)));
}
